#include "editor.h"

#include <algorithm>
#include <cstdlib>
#include <exception>
#include <new>
#include <string>

#include <nlohmann/json.hpp>

#include "orbifit/model/annotation_io.h"
#include "orbifit/model/errors.h"
#include "orbifit/model/scan_io.h"
#include "orbifit/subspace/radius_field.h"

#include "session.h"

using orbifit::Motion;
using orbifit::Points;
using orbifit::editor::Session;
using orbifit::editor::Side;
using orbifit::editor::SurfacePoint;

struct EditorSession : Session {
  std::string text;                 // of the last answer
  std::vector<float> orbit_points;  // shown places
  std::vector<float> scan_points;
};

namespace {

std::string& last_error() {
  static std::string text;
  return text;
}

// What the call returns, or `failed` with the reason kept.
template <class Result, class Call>
Result guarded(Result failed, const Call& call) {
  try {
    return call();
  } catch (const std::bad_alloc&) {
    last_error() = "not enough memory";
  } catch (const std::exception& error) {
    last_error() = error.what();
  }
  return failed;
}

template <class Call>
int done(const Call& call) {
  return guarded(-1, [&] {
    call();
    return 0;
  });
}

Side side_of(int side) {
  return side == 1 ? orbifit::editor::kFree : orbifit::editor::kSymmetric;
}

Points points_of(const EditorSession& session, const double* numbers) {
  return Eigen::Map<const Points>(numbers, session.mesh().vertices.rows(), 3);
}

SurfacePoint surface_point(const EditorSession& session, int face, const double* barycentric) {
  if (face < 0 || face >= session.mesh().faces.rows()) throw orbifit::UsageError("no such face");
  SurfacePoint point;
  point.face = face;
  point.barycentric = Eigen::Map<const Eigen::Vector3d>(barycentric);
  for (int k = 0; k < 3; ++k) {
    point.point += point.barycentric[k] * session.mesh().vertices.row(session.mesh().faces(face, k)).transpose();
  }
  return point;
}

void put(const Motion& motion, double* numbers) {
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) numbers[4 * row + column] = motion.linear(row, column);
    numbers[4 * row + 3] = motion.translation[row];
  }
}

}  // namespace

EditorSession* editor_new() {
  return guarded<EditorSession*>(nullptr, [] { return new EditorSession; });
}

void editor_free(EditorSession* session) {
  delete session;
}

const char* editor_error() {
  return last_error().c_str();
}

uint8_t* editor_allocate(int bytes) {
  return static_cast<uint8_t*>(std::malloc(static_cast<std::size_t>(bytes)));
}

void editor_release(void* memory) {
  std::free(memory);
}

int editor_read_mesh(EditorSession* session, const char* file) {
  return done([&] { session->read_mesh(file); });
}

int editor_read_annotation(EditorSession* session, const char* file, int consistent) {
  return done([&] { session->read_annotation(file, consistent != 0); });
}

int editor_read_basis(EditorSession* session, const char* file) {
  return done([&] { session->read_basis(file); });
}

int editor_write_basis(EditorSession* session, const char* file) {
  return done([&] { session->write_basis(file); });
}

int editor_write_mesh(EditorSession* session, const char* file, int at_rest) {
  return done([&] { at_rest != 0 ? session->write_rest(file) : session->write_shown(file); });
}

int editor_build_basis(EditorSession* session, int mode, int lift, double radius, int samples, int sharp,
                       const char* radius_field) {
  return done([&] {
    if (mode < 0 || mode > 2) throw orbifit::UsageError("mode: 0, 1 or 2");
    if (lift < 0 || lift > 1) throw orbifit::UsageError("lift: 0 or 1");
    orbifit::SubspaceOptions options;
    options.mode = static_cast<orbifit::GroupMode>(mode);
    options.lift = lift == 0 ? orbifit::LiftKind::orbit : orbifit::LiftKind::paper;
    options.radius = radius;
    options.samples = samples;
    options.sharp_features_first = sharp != 0;
    options.validate();
    if (radius_field != nullptr) {
      options.relative_radii = orbifit::relative_radii(session->mesh(), radius_field, options, session->context);
    }
    session->build_basis(options);
  });
}

const char* editor_annotation(EditorSession* session) {
  return guarded<const char*>(nullptr, [&] {
    session->text = orbifit::to_json(session->annotation());
    return session->text.c_str();
  });
}

const char* editor_info(EditorSession* session) {
  return guarded<const char*>(nullptr, [&] {
    const orbifit::editor::DisplayMesh& display = session->display(orbifit::editor::kSymmetric);
    const Eigen::Vector3d& centre = display.centre();
    nlohmann::ordered_json info{{"vertices", session->mesh().vertices.rows()},
                                {"faces", session->mesh().faces.rows()},
                                {"diagonal", display.scale()},
                                {"centre", {centre.x(), centre.y(), centre.z()}},
                                {"regions", session->annotation().regions.size()}};
    if (session->has_basis()) {
      info["mode"] = orbifit::to_string(session->subspace().mode());
      info["samples"] = session->subspace().samples().rows();
      info["degrees_of_freedom"] = session->subspace().degrees_of_freedom();
    }
    session->text = info.dump();
    return session->text.c_str();
  });
}

int editor_display_vertices(EditorSession* session) {
  return static_cast<int>(session->display(orbifit::editor::kSymmetric).vertices());
}

int editor_display_triangles(EditorSession* session) {
  return static_cast<int>(session->display(orbifit::editor::kSymmetric).triangles().size() / 3);
}

const uint32_t* editor_triangles(EditorSession* session) {
  return session->display(orbifit::editor::kSymmetric).triangles().data();
}

const float* editor_positions(EditorSession* session, int side) {
  return session->display(side_of(side)).positions().data();
}

const float* editor_normals(EditorSession* session, int side) {
  return session->display(side_of(side)).normals().data();
}

const uint8_t* editor_marks(EditorSession* session) {
  return session->marks().data();
}

const double* editor_vertices(EditorSession* session, int side) {
  return session->vertices(side_of(side)).data();
}

int editor_set_handles(EditorSession* session, const char* file) {
  return guarded(-1, [&] {
    session->set_handles(file);
    return static_cast<int>(session->handles().handles.size());
  });
}

int editor_handle_centroid(EditorSession* session, int handle, double* centroid) {
  return guarded(-1, [&] {
    const orbifit::Handle& asked = session->handles().handles.at(static_cast<std::size_t>(handle));
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const int vertex : asked.vertices) sum += session->mesh().vertices.row(vertex).transpose();
    Eigen::Map<Eigen::Vector3d>(centroid, 3) = sum / static_cast<double>(asked.vertices.size());
    return static_cast<int>(asked.vertices.size());
  });
}

int editor_solve(EditorSession* session, int side, const double* motions, int count, int iterations, int onwards,
                 double* record) {
  return done([&] {
    std::vector<Motion> list(static_cast<std::size_t>(count));
    for (std::size_t i = 0; i < list.size(); ++i) {
      const Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>> rows(motions + 12 * i);
      list[i].linear = rows.leftCols<3>();
      list[i].translation = rows.col(3);
    }
    const orbifit::editor::SolveRecord found =
        session->solve(side_of(side), list, std::max(1, iterations), onwards != 0);
    record[0] = found.solve_ms;
    record[1] = found.lift_ms;
    record[2] = found.show_ms;
    record[3] = found.handle_error;
    record[4] = found.energy;
  });
}

int editor_rest(EditorSession* session) {
  return done([&] { session->rest(); });
}

int editor_show(EditorSession* session, const double* vertices) {
  return done([&] { session->show(points_of(*session, vertices)); });
}

int editor_compare(EditorSession* session, const char* basis) {
  return done([&] { basis != nullptr ? session->compare(basis) : session->stop_comparing(); });
}

int editor_residuals(EditorSession* session, int kind, double* numbers) {
  return guarded(-1, [&] {
    const auto residuals = kind == 2 ? session->shape_residuals() : session->residuals(side_of(kind));
    for (std::size_t r = 0; r < residuals.size(); ++r) {
      numbers[2 * r] = residuals[r].rms;
      numbers[2 * r + 1] = residuals[r].max;
    }
    return static_cast<int>(residuals.size());
  });
}

int editor_carried(EditorSession* session, int region, double* motion) {
  return done([&] { put(session->carried(region), motion); });
}

int editor_pick(EditorSession* session, const double* ray, double* point) {
  return guarded(-2, [&] {
    const auto found =
        session->pick(Eigen::Map<const Eigen::Vector3d>(ray), Eigen::Map<const Eigen::Vector3d>(ray + 3));
    if (!found) return -1;
    Eigen::Map<Eigen::Vector3d>(point, 3) = session->shown(*found);
    Eigen::Map<Eigen::Vector3d>(point + 3, 3) = found->barycentric;
    return found->face;
  });
}

int editor_orbit(EditorSession* session, int face, const double* barycentric, double radius) {
  return guarded(-1, [&] {
    const auto& orbit = session->orbit(surface_point(*session, face, barycentric), radius);
    session->orbit_points.clear();
    for (const SurfacePoint& image : orbit) {
      const Eigen::Vector3f shown = session->shown(image).cast<float>();
      session->orbit_points.insert(session->orbit_points.end(), shown.data(), shown.data() + 3);
    }
    return static_cast<int>(orbit.size());
  });
}

const float* editor_orbit_points(EditorSession* session) {
  return session->orbit_points.data();
}

int editor_rest_point(EditorSession* session, int face, const double* barycentric, double* point) {
  return done([&] { Eigen::Map<Eigen::Vector3d>(point, 3) = surface_point(*session, face, barycentric).point; });
}

int editor_regions_of(EditorSession* session, int face, int32_t* regions, int most) {
  return guarded(-1, [&] {
    const std::vector<int> found = session->regions_of(face);
    const std::size_t count = std::min(found.size(), static_cast<std::size_t>(most));
    std::copy_n(found.begin(), count, regions);
    return static_cast<int>(count);
  });
}

int editor_mark_region(EditorSession* session, int region) {
  return done([&] { session->mark_region(region); });
}

int editor_clear_orbit(EditorSession* session) {
  return done([&] { session->clear_marks(Session::kOrbit); });
}

const char* editor_symmetrize(EditorSession* session) {
  return guarded<const char*>(nullptr, [&] {
    session->text = session->symmetrize();
    return session->text.c_str();
  });
}

const double* editor_symmetric(EditorSession* session) {
  return session->symmetric().data();
}

int editor_set_symmetric(EditorSession* session, const double* vertices) {
  return done([&] { session->set_symmetric(points_of(*session, vertices)); });
}

int editor_blend(EditorSession* session, double share) {
  return done([&] { session->blend(share); });
}

int editor_keep_blend(EditorSession* session, double share) {
  return done([&] { session->keep_blend(share); });
}

int editor_read_scan(EditorSession* session, const char* file) {
  return guarded(-1, [&] {
    const orbifit::PointCloud scan = orbifit::read_scan(file);
    const orbifit::editor::DisplayMesh& display = session->display(orbifit::editor::kSymmetric);
    session->scan_points.clear();
    for (Eigen::Index i = 0; i < scan.points.rows(); ++i) {
      const Eigen::Vector3f shown =
          ((scan.points.row(i).transpose() - display.centre()) / display.scale()).cast<float>();
      session->scan_points.insert(session->scan_points.end(), shown.data(), shown.data() + 3);
    }
    return static_cast<int>(scan.points.rows());
  });
}

const float* editor_scan_points(EditorSession* session) {
  return session->scan_points.data();
}

const char* editor_fit(EditorSession* session, const char* scan, int place, EditorFitStep step) {
  return guarded<const char*>(nullptr, [&] {
    const orbifit::FitResult result =
        session->fit(scan, place != 0, [&](const orbifit::FitIteration& iteration, int number) {
          if (step != nullptr) step(number, iteration.rms, iteration.stiffness);
        });
    session->text = nlohmann::ordered_json{{"converged", result.converged},
                                           {"stopped_because", result.stopped_because},
                                           {"rms", result.rms},
                                           {"inlier_ratio", result.inlier_ratio},
                                           {"confidence", result.confidence},
                                           {"field_residual", result.field_residual},
                                           {"iterations", result.iterations_in_all}}
                        .dump();
    return session->text.c_str();
  });
}

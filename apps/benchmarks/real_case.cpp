#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

#include "orbifit/detection/detect.h"
#include "orbifit/model/annotation_io.h"
#include "orbifit/model/consistent_annotation.h"
#include "orbifit/model/errors.h"
#include "orbifit/subspace/deformer.h"
#include "orbifit/subspace/displacement_field.h"

#include "base/random.h"
#include "basis/subspace_parts.h"
#include "geometry/point_index.h"
#include "geometry/sampling.h"
#include "real.h"
#include "stopwatch.h"

namespace orbifit::benchmarks {

namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

// The two functions that say how the program comes from a mesh to a subspace.

SymmetryAnnotation detect_as_the_program(const Mesh& mesh, RunContext& context) {
  return detect(mesh, DetectOptions{}, context);
}

// `annotation` becomes what is kept of it.
Subspace build_as_the_program(const Mesh& mesh, SymmetryAnnotation& annotation, const SubspaceOptions& options,
                              const RunContext& context) {
  annotation = made_consistent(mesh, annotation, context);
  return build_subspace(mesh, annotation, options, context);
}

RunContext limited(RunContext context, double seconds) {
  if (seconds > 0) {
    context.deadline =
        std::chrono::steady_clock::now() + std::chrono::microseconds(static_cast<std::int64_t>(1e6 * seconds));
  }
  return context;
}

// The largest region, where it has nearly all of the area; null: none has.
const Region* region_of_the_whole(const SymmetryAnnotation& annotation, const Eigen::VectorXd& areas) {
  constexpr double kWhole = 0.98;  // of the area
  const Region* largest = nullptr;
  double most = kWhole * areas.sum();
  for (const Region& region : annotation.regions) {
    double area = 0;
    for (const int face : region.faces) area += areas[face];
    if (area < most || (largest != nullptr && area == most)) continue;
    most = area;
    largest = &region;
  }
  return largest;
}

Handle random_handle(const Mesh& mesh, Random& random, const std::string& name, bool turned) {
  constexpr double kRadius = 0.08;       // of the diagonal
  constexpr double kTranslation = 0.05;  // of the diagonal
  constexpr double kDegrees = 20;
  const double size = diagonal(mesh.vertices);
  const Vector3d centre = sample_surface(mesh, 1, random).points.row(0).transpose();
  const Eigen::VectorXd distances = (mesh.vertices.rowwise() - centre.transpose()).rowwise().norm();
  Handle handle;
  handle.name = name;
  for (Eigen::Index v = 0; v < distances.size(); ++v) {
    if (distances[v] <= kRadius * size) handle.vertices.push_back(static_cast<int>(v));
  }
  if (handle.vertices.empty()) {  // within a large triangle
    Eigen::Index nearest = 0;
    distances.minCoeff(&nearest);
    handle.vertices.push_back(static_cast<int>(nearest));
  }
  const Vector3d along = random.direction();
  if (turned) {
    Vector3d mean = Vector3d::Zero();
    for (const int v : handle.vertices) mean += mesh.vertices.row(v).transpose();
    mean /= static_cast<double>(handle.vertices.size());
    handle.motion = Motion::rotation(random.direction(), kDegrees * std::numbers::pi / 180, mean);
  }
  handle.motion.translation += kTranslation * size * along;
  return handle;
}

struct MeshResidual {
  double worst = 0;
  long long pairs = 0;
};

// Where vertices lie on the images of vertices at rest: how far the deformed ones are from the carried images of the
// deformed ones, less what they are apart at rest. Of vertices at one place the nearest counts.
MeshResidual mesh_residual(const Mesh& mesh, const Points& displacements, const Subspace& subspace,
                           const SymmetryAnnotation& annotation, const SubspaceState& state,
                           const RunContext& context) {
  constexpr double kSamePlace = 1e-9;   // of the diagonal
  constexpr std::size_t kMax = 200000;  // pairs of one region; beyond, every k-th vertex
  const double size = diagonal(mesh.vertices);
  MeshResidual result;
  for (std::size_t r = 0; r < annotation.regions.size(); ++r) {
    const int number = static_cast<int>(r);
    const std::vector<int> vertices = vertices_of_faces(mesh, annotation.regions[r].faces);
    Points places(static_cast<Eigen::Index>(vertices.size()), 3);
    for (std::size_t v = 0; v < vertices.size(); ++v) {
      places.row(static_cast<Eigen::Index>(v)) = mesh.vertices.row(vertices[v]);
    }
    const PointIndex index(places);
    const Motion carried = region_motion(subspace, state, number);
    const std::vector<Motion> elements = subspace->regions->test_elements(number);
    const std::size_t step = 1 + vertices.size() * elements.size() / kMax;
    for (std::size_t v = 0; v < vertices.size(); v += step) {
      if (v / step % 64 == 0) context.check();
      const Vector3d rest = mesh.vertices.row(vertices[v]).transpose();
      const Vector3d deformed = rest + displacements.row(vertices[v]).transpose();
      for (const Motion& element : elements) {
        const Vector3d image = element(rest);
        const Vector3d carried_image = conjugate(carried, element)(deformed);
        double least = -1;
        for (const PointIndex::Neighbour& near : index.within(image, kSamePlace * size)) {
          const int other = vertices[static_cast<std::size_t>(near.index)];
          const Vector3d there = image + displacements.row(other).transpose();
          const double apart = (there - carried_image).norm() / size;
          if (least < 0 || apart < least) least = apart;
        }
        if (least < 0) continue;
        result.worst = std::max(result.worst, least);
        ++result.pairs;
      }
    }
  }
  return result;
}

RealMode measure_mode(const Mesh& mesh, const std::vector<Handle>& handles, const SymmetryAnnotation& listed,
                      const Region* whole, GroupMode mode, const RunContext& given) {
  constexpr double kAlpha = 100;  // as a file of handles that does not say
  constexpr int kIterations = 10;
  RealMode result;
  result.mode = mode;
  RunContext context = given;
  context.on_message = [&](std::string_view text) {
    if (!result.messages.empty()) result.messages += "; ";
    result.messages += text;
  };
  try {
    SymmetryAnnotation kept = listed;
    SubspaceOptions options;
    options.mode = mode;
    double start = seconds_now();
    const Subspace built = build_as_the_program(mesh, kept, options, context);
    result.build_seconds = seconds_now() - start;
    result.regions = static_cast<int>(kept.regions.size());
    result.patterns = static_cast<int>(kept.patterns.size());
    result.whole = whole == nullptr || std::ranges::any_of(kept.regions, [&](const Region& region) {
                     return region.group.symbol() == whole->group.symbol() && region.faces == whole->faces;
                   });
    start = seconds_now();
    Deformer deformer(built, mesh, {}, context);
    deformer.set_handles(handles, kAlpha);
    std::vector<Motion> motions;
    for (const Handle& handle : handles) motions.push_back(handle.motion);
    const Deformation deformation = deformer.solve(motions, kIterations);
    result.solve_seconds = seconds_now() - start;
    const Points displacements = vertex_displacements(built, deformation.state, context);
    result.field_residual = worst_field_residual(built, mesh, kept, deformation.state, context);
    const MeshResidual residual = mesh_residual(mesh, displacements, built, kept, deformation.state, context);
    result.mesh_residual = residual.worst;
    result.mesh_pairs = residual.pairs;
    if (!displacements.allFinite()) result.failure = "a displacement is not finite";
  } catch (const InterruptedError&) {
    throw;
  } catch (const std::exception& error) {
    result.failure = error.what();
  }
  return result;
}

}  // namespace

double allowed_build_seconds(int vertices) {
  constexpr double kAtLeast = 3;
  constexpr double kVerticesASecond = 50000;
  return std::max(kAtLeast, vertices / kVerticesASecond);
}

RealRow measure_real(const RealMesh& real, const std::vector<GroupMode>& modes, const fs::path& annotation,
                     double stage_limit, const RunContext& given) {
  const Mesh& mesh = real.mesh;
  RealRow row;
  row.name = real.name;
  row.file = real.file;
  row.vertices = static_cast<int>(mesh.vertices.rows());
  row.faces = static_cast<int>(mesh.faces.rows());
  row.allowed_seconds = allowed_build_seconds(row.vertices);
  try {
    SymmetryAnnotation listed;
    if (!annotation.empty() && fs::exists(annotation)) {
      listed = read_annotation(annotation, mesh);
    } else {
      RunContext context = limited(given, stage_limit);
      const double start = seconds_now();
      listed = detect_as_the_program(mesh, context);
      row.detect_seconds = seconds_now() - start;
      if (!annotation.empty()) write_annotation(annotation, listed);
    }
    row.regions = static_cast<int>(listed.regions.size());
    row.patterns = static_cast<int>(listed.patterns.size());
    const Region* whole = region_of_the_whole(listed, face_areas(mesh));
    row.whole = whole != nullptr;
    Random random(given.seed, real.name);
    std::vector<Handle> handles;
    handles.push_back(random_handle(mesh, random, "moved", false));
    handles.push_back(random_handle(mesh, random, "turned", true));
    for (const GroupMode mode : modes) {
      row.modes.push_back(measure_mode(mesh, handles, listed, whole, mode, limited(given, stage_limit)));
    }
  } catch (const InterruptedError&) {
    throw;
  } catch (const std::exception& error) {
    row.failure = error.what();
  }
  return row;
}

}  // namespace orbifit::benchmarks

#include "surface/surface_patch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <string>
#include <utility>

#include <Eigen/Geometry>

#include "orbifit/model/errors.h"

#include "base/random.h"
#include "surface/creases.h"
#include "surface/surface_ends.h"
#include "surface/thresholds.h"

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Faces with the same welded corners as an earlier one of their component carry no area of their own: a sheet modelled
// with two sides would else weigh double and pull the centroid away from the axis.
void silence_repeated_faces(const Mesh& mesh, const Weld& weld, const Components& components, Eigen::VectorXd& areas) {
  std::vector<std::pair<std::array<int, 4>, int>> corners(static_cast<std::size_t>(mesh.faces.rows()));
  for (int f = 0; f < mesh.faces.rows(); ++f) {
    std::array<int, 4> key{};
    for (int k = 0; k < 3; ++k) {
      key[static_cast<std::size_t>(k)] = weld.group_of_vertex[static_cast<std::size_t>(mesh.faces(f, k))];
    }
    std::sort(key.begin(), key.begin() + 3);
    key[3] = components.component_of_face[static_cast<std::size_t>(f)];
    corners[static_cast<std::size_t>(f)] = {key, f};
  }
  std::ranges::sort(corners);
  for (std::size_t i = 1; i < corners.size(); ++i) {
    if (corners[i].first == corners[i - 1].first) areas[corners[i].second] = 0;
  }
}

std::vector<char> at_creases(const PreparedMesh& prepared, const SurfaceSamples& samples, double reach,
                             const RunContext& context) {
  std::vector<char> result(static_cast<std::size_t>(samples.points.rows()));
  parallel_for(context, result.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      const Vector3d point = samples.points.row(static_cast<Eigen::Index>(s));
      result[s] = near_crease(prepared, point, samples.faces[s], reach) ? 1 : 0;
    }
  });
  return result;
}

// Samples of each component that matters, so that none is too small to be seen.
SurfaceSamples samples_of_parts(const PreparedMesh& prepared, const std::vector<int>& visible, double area,
                                Random& random) {
  constexpr double kMatters = 0.002;  // of the patch's area
  std::map<int, std::vector<int>> parts;
  for (const int f : visible) parts[prepared.components.component_of_face[static_cast<std::size_t>(f)]].push_back(f);
  SurfaceSamples result;
  if (parts.size() < 2) return result;
  const auto append = [](Points& to, const Points& more) {
    to.conservativeResize(to.rows() + more.rows(), 3);
    to.bottomRows(more.rows()) = more;
  };
  for (const auto& [number, faces] : parts) {
    double part_area = 0;
    for (const int f : faces) part_area += prepared.areas[f];
    if (part_area < kMatters * area) continue;
    const SurfaceSamples part =
        sample_surface(prepared.mesh, prepared.areas, prepared.normals, SurfacePatch::kPartSamples, random, faces);
    append(result.points, part.points);
    append(result.normals, part.normals);
    result.faces.insert(result.faces.end(), part.faces.begin(), part.faces.end());
  }
  return result;
}

}  // namespace

void require_finite(const Mesh& mesh) {
  if (!mesh.vertices.allFinite()) throw InputError("", "vertices", "a coordinate is not finite");
}

PreparedMesh prepare(const Mesh& mesh) {
  require_finite(mesh);
  PreparedMesh result;
  const double size = diagonal(mesh.vertices);
  if (!(size > 0)) throw InputError("", "", "the mesh has no extent");
  const Vector3d centre = bounding_box_centre(mesh.vertices);
  result.input_of_normalised = {size, Matrix3d::Identity(), centre};
  result.mesh = mesh;
  result.mesh.vertices = (mesh.vertices.rowwise() - centre.transpose()) / size;
  result.weld = weld_vertices(result.mesh.vertices, kWeldTolerance);
  result.components = touching_parts(result.mesh, result.weld);
  result.normals = face_normals(result.mesh);
  result.areas = face_areas(result.mesh);
  silence_repeated_faces(result.mesh, result.weld, result.components, result.areas);
  result.area = result.areas.sum();
  if (!(result.area > 0)) throw InputError("", "faces", "the mesh has no area");
  result.faces_of_vertex.resize(result.weld.representative.size());
  for (int f = 0; f < mesh.faces.rows(); ++f) {
    if (result.areas[f] <= 0) continue;
    for (int k = 0; k < 3; ++k) {
      const int group = result.weld.group_of_vertex[static_cast<std::size_t>(mesh.faces(f, k))];
      result.faces_of_vertex[static_cast<std::size_t>(group)].push_back(f);
    }
  }
  result.index = std::make_shared<const SurfaceIndex>(result.mesh);
  result.ends = end_edges(result);
  return result;
}

double area_of(const PreparedMesh& prepared, const std::vector<int>& faces) {
  double area = 0;
  for (const int face : faces) area += prepared.areas[face];
  return area;
}

SurfaceMoments surface_moments(const PreparedMesh& prepared, const std::vector<int>& faces) {
  SurfaceMoments result;
  Matrix3d second = Matrix3d::Zero();
  Eigen::AlignedBox3d box;
  const auto corner = [&](int face, int k) -> Vector3d {
    return prepared.mesh.vertices.row(prepared.mesh.faces(face, k));
  };
  for (const int f : faces) {
    const double area = prepared.areas[f];
    for (int k = 0; k < 3; ++k) box.extend(corner(f, k));
    result.area += area;
    result.centroid += area / 3 * (corner(f, 0) + corner(f, 1) + corner(f, 2));
  }
  result.diagonal = box.isEmpty() ? 0 : box.diagonal().norm();
  if (result.area <= 0) {
    if (!box.isEmpty()) result.centroid = box.center();
    return result;
  }
  result.centroid /= result.area;
  double farthest = 0;  // squared
  for (const int f : faces) {
    // Over a triangle the integral of x x^T is area / 12 (sum of v v^T + s s^T) with s the sum of the corners.
    Vector3d sum = Vector3d::Zero();
    Matrix3d outer = Matrix3d::Zero();
    for (int k = 0; k < 3; ++k) {
      const Vector3d v = corner(f, k) - result.centroid;
      farthest = std::max(farthest, v.squaredNorm());
      sum += v;
      outer += v * v.transpose();
    }
    second += prepared.areas[f] / 12 * (outer + sum * sum.transpose());
  }
  result.radius = std::sqrt(farthest);
  result.covariance = second / result.area;
  return result;
}

namespace {

std::vector<int> visible_faces(const PreparedMesh& prepared, const std::vector<int>& faces) {
  std::vector<int> visible;
  visible.reserve(faces.size());
  for (const int f : faces) {
    if (prepared.areas[f] > 0) visible.push_back(f);
  }
  return visible;
}

}  // namespace

SurfacePatch sample_patch(const PreparedMesh& prepared, std::vector<int> faces, int samples, double tolerance,
                          const RunContext& context, std::string_view stream) {
  SurfacePatch patch;
  patch.prepared = &prepared;
  std::ranges::sort(faces);
  patch.moments = surface_moments(prepared, faces);
  patch.relative_tolerance = tolerance;
  patch.tolerance = tolerance_of_part(tolerance, patch.moments.diagonal);
  Random random(context.seed, stream);
  patch.samples =
      sample_surface(prepared.mesh, prepared.areas, prepared.normals, samples, random, visible_faces(prepared, faces));
  patch.at_crease.assign(static_cast<std::size_t>(patch.samples.points.rows()), 0);
  patch.faces = std::move(faces);
  return patch;
}

SurfacePatch make_patch(const PreparedMesh& prepared, std::vector<int> faces, int samples, double tolerance,
                        const RunContext& context, std::string_view stream) {
  SurfacePatch patch = sample_patch(prepared, std::move(faces), samples, tolerance, context, stream);
  const std::vector<int> visible = visible_faces(prepared, patch.faces);
  patch.index = std::make_shared<const SurfaceIndex>(prepared.index->part(visible));
  const double reach = kCreaseReach * patch.tolerance;
  patch.at_crease = at_creases(prepared, patch.samples, reach, context);
  Random random(context.seed, std::string(stream) + " parts");
  patch.part_samples = samples_of_parts(prepared, visible, patch.moments.area, random);
  patch.part_at_crease = at_creases(prepared, patch.part_samples, reach, context);
  return patch;
}

}  // namespace orbifit

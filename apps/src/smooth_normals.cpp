#include "smooth_normals.h"

#include <cmath>
#include <numbers>

#include "geometry/topology.h"

namespace orbifit {

std::vector<Eigen::Vector3f> corner_normals(const Mesh& mesh, double crease_degrees) {
  const auto face_count = static_cast<std::size_t>(mesh.faces.rows());
  const Weld weld = weld_vertices(mesh.vertices, 1e-7 * diagonal(mesh.vertices));
  const Points normals = face_normals(mesh);
  const Eigen::VectorXd areas = face_areas(mesh);
  const auto group = [&](std::size_t face, int corner) {
    const int vertex = mesh.faces(static_cast<Eigen::Index>(face), corner);
    return static_cast<std::size_t>(weld.group_of_vertex[static_cast<std::size_t>(vertex)]);
  };

  // The faces around each group of vertices, one list after the other.
  std::vector<std::size_t> start(weld.representative.size() + 1, 0);
  for (std::size_t f = 0; f < face_count; ++f) {
    for (int k = 0; k < 3; ++k) ++start[group(f, k) + 1];
  }
  for (std::size_t g = 1; g < start.size(); ++g) start[g] += start[g - 1];
  std::vector<int> around(3 * face_count);
  std::vector<std::size_t> next(start.begin(), start.end() - 1);
  for (std::size_t f = 0; f < face_count; ++f) {
    for (int k = 0; k < 3; ++k) around[next[group(f, k)]++] = static_cast<int>(f);
  }

  const double crease = std::cos(crease_degrees * std::numbers::pi / 180);
  std::vector<Eigen::Vector3f> result(3 * face_count);
  for (std::size_t f = 0; f < face_count; ++f) {
    const Eigen::RowVector3d own = normals.row(static_cast<Eigen::Index>(f));
    for (int k = 0; k < 3; ++k) {
      const std::size_t at = group(f, k);
      Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
      for (std::size_t i = start[at]; i < start[at + 1]; ++i) {
        const double cosine = own.dot(normals.row(around[i]));
        if (std::abs(cosine) > crease) sum += std::copysign(areas[around[i]], cosine) * normals.row(around[i]);
      }
      const double length = sum.norm();
      const Eigen::RowVector3d normal = length > 0 ? Eigen::RowVector3d(sum / length) : own;
      result[3 * f + static_cast<std::size_t>(k)] = normal.transpose().cast<float>();
    }
  }
  return result;
}

}  // namespace orbifit

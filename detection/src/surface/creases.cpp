#include "surface/creases.h"

#include <cmath>
#include <vector>

#include "surface/thresholds.h"

namespace orbifit {

bool near_crease(const PreparedMesh& prepared, const Eigen::Vector3d& point, int face, double reach) {
  using Eigen::Vector3d;
  const Vector3d normal = prepared.normals.row(face);
  for (int k = 0; k < 3; ++k) {
    const int group = prepared.weld.group_of_vertex[static_cast<std::size_t>(prepared.mesh.faces(face, k))];
    const std::vector<int>& around = prepared.faces_of_vertex[static_cast<std::size_t>(group)];
    if (around.size() > 64) continue;  // the apex of a fan: its faces are seen from their other corners
    for (const int other : around) {
      if (std::abs(normal.dot(prepared.normals.row(other))) > kAlikeNormals) continue;
      const Vector3d a = prepared.mesh.vertices.row(prepared.mesh.faces(other, 0));
      const Vector3d b = prepared.mesh.vertices.row(prepared.mesh.faces(other, 1));
      const Vector3d c = prepared.mesh.vertices.row(prepared.mesh.faces(other, 2));
      const Vector3d weights = nearest_on_triangle(point, a, b, c);
      if ((weights[0] * a + weights[1] * b + weights[2] * c - point).norm() <= reach) return true;
    }
  }
  return false;
}

}  // namespace orbifit

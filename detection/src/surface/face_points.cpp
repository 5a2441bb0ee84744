#include "surface/face_points.h"

#include <algorithm>
#include <cmath>

#include "surface/thresholds.h"

namespace orbifit {

Eigen::Vector3d face_centroid(const PreparedMesh& prepared, int face) {
  const Eigen::RowVector3i corners = prepared.mesh.faces.row(face);
  return (prepared.mesh.vertices.row(corners[0]) + prepared.mesh.vertices.row(corners[1]) +
          prepared.mesh.vertices.row(corners[2]))
             .transpose() /
         3;
}

void face_points(const PreparedMesh& prepared, int face, double spacing, int most_cuts,
                 std::vector<Eigen::Vector3d>& points) {
  points.clear();
  const auto corner = [&](int k) -> Eigen::Vector3d {
    return prepared.mesh.vertices.row(prepared.mesh.faces(face, k));
  };
  const Eigen::Vector3d a = corner(0);
  const Eigen::Vector3d u = corner(1) - a;
  const Eigen::Vector3d v = corner(2) - a;
  const double longest = std::max({u.norm(), v.norm(), (u - v).norm()});
  const int cuts = static_cast<int>(std::clamp(std::ceil(longest / spacing), 1.0, static_cast<double>(most_cuts)));
  for (int i = 0; i < cuts; ++i) {
    for (int j = 0; i + j < cuts; ++j) {
      points.emplace_back(a + ((i + 1.0 / 3) * u + (j + 1.0 / 3) * v) / cuts);
      if (i + j + 1 < cuts) points.emplace_back(a + ((i + 2.0 / 3) * u + (j + 2.0 / 3) * v) / cuts);
    }
  }
}

bool stays_on(const SurfacePatch& patch, const std::vector<Motion>& motions, int face) {
  const Eigen::Vector3d centroid = face_centroid(*patch.prepared, face);
  const Eigen::Vector3d normal = patch.prepared->normals.row(face);
  return std::ranges::all_of(motions, [&](const Motion& motion) {
    return patch.index->within_facing(motion(centroid), motion.linear * normal, kFacetNormals, patch.tolerance);
  });
}

}  // namespace orbifit

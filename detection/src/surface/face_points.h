#pragma once

#include <vector>

#include "surface/surface_patch.h"

namespace orbifit {

Eigen::Vector3d face_centroid(const PreparedMesh& prepared, int face);

/// Points that stand for a face: the centroids of the k^2 equal triangles into which k cuts of each edge divide it, so
/// that they are about `spacing` apart, k at most `most_cuts`.
/// \param[out] points replaced
void face_points(const PreparedMesh& prepared, int face, double spacing, int most_cuts,
                 std::vector<Eigen::Vector3d>& points);

/// Whether three of four points of a face, its centroid and those half-way to its corners, satisfy a predicate.
template <typename Predicate>
bool most_of_face(const PreparedMesh& prepared, int face, const Predicate& holds) {
  const Eigen::Vector3d centroid = face_centroid(prepared, face);
  int hits = 0;
  int misses = 0;
  for (int k = 3; k >= 0 && hits < 3 && misses < 2; --k) {
    Eigen::Vector3d point = centroid;
    if (k < 3) point = 0.5 * (centroid + prepared.mesh.vertices.row(prepared.mesh.faces(face, k)).transpose());
    ++(holds(point) ? hits : misses);
  }
  return hits >= 3;
}

/// Whether every motion brings the face's centroid to within the patch's tolerance of it, and of a face whose normal is
/// within 50 degrees.
bool stays_on(const SurfacePatch& patch, const std::vector<Motion>& motions, int face);

}  // namespace orbifit

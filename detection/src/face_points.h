#pragma once

#include <vector>

#include "orbifit/detection/surface_patch.h"

namespace orbifit {

Eigen::Vector3d face_centroid(const PreparedMesh& prepared, int face);

/// Points that stand for a face: the centroids of the k^2 equal triangles into which k cuts of each edge divide it, so
/// that they are about `spacing` apart, k at most `most_cuts`.
/// \param[out] points replaced
void face_points(const PreparedMesh& prepared, int face, double spacing, int most_cuts,
                 std::vector<Eigen::Vector3d>& points);

}  // namespace orbifit

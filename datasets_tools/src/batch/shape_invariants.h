#pragma once

#include <array>

#include "orbifit/model/mesh.h"

namespace orbifit::batch {

/// Numbers that a similarity of a surface leaves as they are and that do not depend on how it is cut into triangles.
/// Two shapes that are the same up to a similarity have the same ones; the converse is to be confirmed (same_shape.h).
struct ShapeInvariants {
  /// With r the distance from the surface's centroid and s the root of the mean of r^2: the two largest eigenvalues of
  /// the second moments over s^2, the area over s^2, and the means of r^4 over s^4 and of r^6 over s^6.
  std::array<double, 5> values{};
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  double size = 0;  ///< s, mesh units; 0 for a surface without area, whose values are 0
};

/// O(F); the integrals are exact but for rounding.
ShapeInvariants shape_invariants(const Mesh& mesh);

}  // namespace orbifit::batch

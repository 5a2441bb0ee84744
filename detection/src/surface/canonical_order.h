#pragma once

#include <vector>

#include "orbifit/model/mesh.h"

namespace orbifit {

/// A mesh with its faces, their corners and its vertices in an order that follows from where they are: whatever order
/// they were given in, the same comes out, but for faces that are alike to the last digit. Faces go round as they did.
/// Neighbours come to lie next to one another.
struct CanonicalOrder {
  Mesh mesh;
  std::vector<int> face_of;  ///< #F: of each of its faces the number in the mesh given

  /// O(F log F). \pre coordinates are finite
  /// \param grid  coordinates that round to the same multiple of it are in no order; 0: those that are equal
  explicit CanonicalOrder(const Mesh& given, double grid = 0);
};

}  // namespace orbifit

#pragma once

#include <vector>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"

namespace orbifit {

/// A mesh with its faces, their corners and its vertices in an order that follows from where they are: whatever order
/// they were given in, the same comes out, but for faces that are alike to the last digit. Faces go round as they did.
/// Neighbours come to lie next to one another.
struct CanonicalOrder {
  Mesh mesh;
  std::vector<int> face_of;  ///< #F: of each of its faces the number in the mesh given

  /// O(F log F). \pre coordinates are finite
  explicit CanonicalOrder(const Mesh& given);

  /// Of the mesh given, what was found of this one: faces ascending.
  SymmetryAnnotation in_given_order(SymmetryAnnotation annotation) const;
};

}  // namespace orbifit

#pragma once

#include <vector>

#include "orbifit/model/mesh.h"

namespace orbifit {

/// A mesh whose vertices and faces are in an order of its own: from one end of the shape to the other, along a
/// direction that is told by where its area lies and turns along with it. Meshes that differ in the order of vertices,
/// of faces or of the corners within faces are the same then; those that differ in their pose too, unless a symmetry of
/// the triangles leaves a choice.
struct OwnOrder {
  Mesh mesh;
  std::vector<int> face;  ///< by the number of a face: the one it was
};

/// Costs O(F log F). Where lengths are too large to compare the order stays as it was. \pre all coordinates are finite
OwnOrder in_own_order(const Mesh& mesh);

}  // namespace orbifit

#pragma once

#include <vector>

#include "orbifit/model/mesh.h"

namespace orbifit {

/// The closed parts of a mesh: what bounds a solid.
struct ClosedParts {
  Mesh mesh;                         ///< the faces that bound, corners at one place share a vertex
  std::vector<int> source_face;      ///< #F of `mesh`: its number in the mesh given
  std::vector<int> part_of_face;     ///< #F
  std::vector<bool> parity_of_part;  ///< whether faces are inconsistently oriented, so that only parity tells inside
};

/// Welds, leaves out faces without extent and the second of two opposite sides, and finds the parts.
/// \throw InputError when a part is not closed: an edge with an odd number of faces
ClosedParts closed_parts(const Mesh& mesh);

}  // namespace orbifit

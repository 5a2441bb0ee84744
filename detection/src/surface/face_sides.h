#pragma once

#include <array>
#include <vector>

#include "surface/surface_patch.h"

namespace orbifit {

/// What is beyond an edge of a face.
struct FaceSide {
  int face = -1;                    ///< the other face at the edge; -1 where there is not just one other
  double length = 0;                ///< of the edge, normalised mesh
  std::array<int, 2> ends{-1, -1};  ///< of the edge, groups of the weld
};

/// #F; of the welded mesh. O(F log F)
std::vector<std::array<FaceSide, 3>> face_sides(const PreparedMesh& prepared);

/// The faces without connected patches of less than a hundredth of their area each, where these are a thirtieth of it
/// together at most: what surfaces are ragged by. O(#faces log #faces)
/// \param faces ascending \param sides of all faces, see face_sides()
std::vector<int> without_specks(const PreparedMesh& prepared, const std::vector<std::array<FaceSide, 3>>& sides,
                                const std::vector<int>& faces);

}  // namespace orbifit

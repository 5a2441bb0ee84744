#pragma once

#include <array>
#include <vector>

#include "orbifit/detection/surface_patch.h"

namespace orbifit {

/// What is beyond an edge of a face.
struct FaceSide {
  int face = -1;                    ///< the other face at the edge; -1 where there is not just one other
  double length = 0;                ///< of the edge, normalised mesh
  std::array<int, 2> ends{-1, -1};  ///< of the edge, groups of the weld
};

/// #F; of the welded mesh. O(F log F)
std::vector<std::array<FaceSide, 3>> face_sides(const PreparedMesh& prepared);

}  // namespace orbifit

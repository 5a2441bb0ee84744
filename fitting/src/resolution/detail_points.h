#pragma once

#include "orbifit/fitting/fit.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

#include "start/placed_scan.h"

namespace orbifit {

/// All points of the scans that stand where a fit has used some, in the template's frame.
struct DetailPoints {
  Points points, normals;       ///< #P by 3
  bool signed_normals = false;  ///< they point outwards
};

/// \param start  as of `result`, whose other scans' motions go on from it. O(P log P)
DetailPoints detail_points(const FitInput& input, const PlacedScan& start, const FitResult& result,
                           const RunContext& context);

}  // namespace orbifit

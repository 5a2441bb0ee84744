#pragma once

#include "orbifit/fitting/fit.h"
#include "orbifit/model/run_context.h"

#include "start/placed_scan.h"

namespace orbifit {

/// Displaces a fit's vertices along their normals by what all points of the scan show beyond the subspace
/// (docs/method.md 7.1): one height for each orbit of vertices, so that every group stays exact. The heights have a
/// Gaussian prior on the quotient surface, alike over a length that is halved as long as points that are held out come
/// nearer; where no image of a vertex is seen they go to zero over that length. Nothing where neighbouring points have
/// next to nothing in common that the fit leaves.
/// \param start  as of `result`, whose other scans' motions go on from it
/// O(levels * iterations of conjugate gradients * (points + vertices))
void add_detail(const FitInput& input, const PlacedScan& start, const FitOptions& options, const RunContext& context,
                FitResult& result);

}  // namespace orbifit

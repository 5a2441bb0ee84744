#pragma once

#include <vector>

#include "orbifit/fitting/fit.h"

#include "scan/scan_preparation.h"
#include "scan/seen_surface.h"

namespace orbifit {

/// The other poses of the fitted surface in which it explains the scan as well. It is put where the placements have the
/// template, at the size that it has, and moved rigidly to the scan. Poses that bring the surface onto itself are one,
/// and so are those that differ in their size alone, which open_stretches() tells. Reads `fitted`, `pose` and
/// `placements`. Costs a placement an alignment of about 600 points. \param seen  of the input's scan and the points
/// of this one
/// \return by how well they explain it (docs/method.md 7.2)
std::vector<OpenPose> open_poses(const PreparedScan& scan, const SeenSurface& seen, const FitOptions& options,
                                 const RunContext& context, const FitResult& result);

}  // namespace orbifit

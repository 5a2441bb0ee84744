#pragma once

#include <vector>

#include "orbifit/fitting/fit.h"

#include "scan/scan_preparation.h"
#include "scan/seen_surface.h"

namespace orbifit {

/// The ways in which the fitted shape can be stretched, its pose following, and explains the scan as well: alike in all
/// directions, and along the axes of its moments of inertia, those together that the groups of the whole take to one
/// another. Reads `fitted` and `annotation`. Costs nine to 25 alignments of about 600 points. \param seen  of the
/// input's scan and the points of this one
/// \return those with a stretch above 0, by the largest one (docs/method.md 7.2)
std::vector<OpenStretch> open_stretches(const PreparedScan& scan, const SeenSurface& seen, const FitOptions& options,
                                        const RunContext& context, const FitResult& result);

}  // namespace orbifit

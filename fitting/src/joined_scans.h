#pragma once

#include <vector>

#include "orbifit/fitting/fit.h"
#include "orbifit/model/run_context.h"

#include "placed_scan.h"
#include "registration/correspondences.h"
#include "scan/scan_preparation.h"

namespace orbifit {

/// Puts the other scans of an input beside the first one in each of its places: where the template is found in both at
/// the same pose, they have one frame; else each scan goes where the pose found in it says. Of each what cannot be the
/// template's is taken away by itself. A scan in which the template is not found is named in a message and left out.
/// \param places  of the first scan \param preparation  of each scan
void join_scans(const FitInput& input, const MatchSurface& surface, const FitOptions& options,
                const ScanPreparationOptions& preparation, const RunContext& context, std::vector<PlacedScan>& places);

/// The start with the other scans and the pose as a fit from there has left them.
/// \param moves  of the others, from where the start has them
PlacedScan rejoined(const PlacedScan& start, const Similarity& pose, const std::vector<Motion>& moves);

/// All points of all scans with known viewpoints, in the frame of the first: what the viewpoints saw.
PointCloud joined_cloud(const FitInput& input, const PlacedScan& start);

}  // namespace orbifit

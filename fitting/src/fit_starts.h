#pragma once

#include <vector>

#include "orbifit/fitting/fit.h"
#include "orbifit/fitting/placement.h"
#include "orbifit/model/run_context.h"

#include "placed_scan.h"
#include "stage_clock.h"

namespace orbifit {

/// Where a fit may start from.
struct FitStarts {
  std::vector<PlacedScan> places;     ///< at least one: those that the scan supports about as well, best first
  std::vector<Placement> placements;  ///< all that were found, best first; empty where none was, or was asked for
};

/// The places found in the scan (FitOptions::place), or else the one that the landmarks say, or the input's pose,
/// refined where FitOptions::align says so. \throw InputError as prepare_scan() does
FitStarts find_starts(const FitInput& input, const FitOptions& options, const RunContext& context, StageClock& clock);

}  // namespace orbifit

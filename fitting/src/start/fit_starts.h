#pragma once

#include <vector>

#include "orbifit/fitting/fit.h"
#include "orbifit/fitting/placement.h"
#include "orbifit/model/run_context.h"

#include "stage_clock.h"
#include "start/placed_scan.h"

namespace orbifit {

/// Where a fit may start from.
struct FitStarts {
  std::vector<PlacedScan> places;     ///< at least one: those that the scan supports about as well, best first
  std::vector<Placement> placements;  ///< all that were found, best first; empty where none was, or was asked for
  std::vector<char> agrees;           ///< of each landmark, whether it agrees with the pose
};

/// The pose that is known (neither FitOptions::place nor FitOptions::align); or that the landmarks say, where they
/// determine one and are not doubted; or the places found in the scan (FitOptions::place), among which fewer landmarks
/// choose; or else the input's pose, refined where FitOptions::align says so. Whatever says the pose, what cannot be
/// the template's there is taken from the scan. \throw InputError as prepare_scan() does
FitStarts find_starts(const FitInput& input, const FitOptions& options, bool doubt_landmarks, const RunContext& context,
                      StageClock& clock);

}  // namespace orbifit

#pragma once

#include <vector>

#include "orbifit/fitting/fit.h"
#include "orbifit/model/run_context.h"

#include "start/placed_scan.h"

namespace orbifit {

/// Of the squared residuals: what a finer fit could gain at most, for one to be worth while.
inline constexpr double kWorthRefining = 0.05;

/// How far the points of a scan lie from a fitted surface: what another fit could still gain, and whether it did.
struct FitResiduals {
  std::vector<double> squared;  ///< of each point, robust: what is far counts as at kLastRobust; squared diagonals
  /// Of the squared residuals, the share that a point and the one nearest to it have in common: shape that is not
  /// fitted yet, and not noise, which differs from one to the next. In [-1, 1].
  double shared = 0;
  double shared_squared = 0;  ///< so much of the mean of all points, squared diagonals; what is far counts as nothing
};

/// \param start  as of `result`
FitResiduals fit_residuals(const FitInput& input, const PlacedScan& start, const FitResult& result,
                           const RunContext& context);

}  // namespace orbifit

#pragma once

#include "orbifit/fitting/fit.h"
#include "orbifit/fitting/scan_preparation.h"

namespace orbifit {

/// What the fitted surface explains of the scan, what the scan saw of it, and how far landmarks are off: fills
/// `inlier_fraction`, `rms`, `covered`, `confidence`, `seen`, `hidden_fraction` and `landmark_rms` from `fitted` and
/// `pose`, `used_fraction` and `torn_off`.
void assess_fit(const FitInput& input, const PreparedScan& scan, const FitOptions& options, const RunContext& context,
                FitResult& result);

}  // namespace orbifit

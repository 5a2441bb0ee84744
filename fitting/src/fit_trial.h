#pragma once

#include "orbifit/fitting/fit.h"
#include "orbifit/model/run_context.h"
#include "orbifit/subspace/subspace.h"

#include "fit_loop.h"
#include "placed_scan.h"

namespace orbifit {

/// Deforms the template within a subspace, from one start, and says how well that explains the scan: all of a result
/// but `converged`, `field_residual` and what concerns the whole of a fit.
/// \param state  where to begin \param first_level  of FitOptions::levels: a deformed state begins softer
FitResult fit_from(FitState state, int first_level, const FitInput& input, const PlacedScan& start,
                   const Subspace& subspace, const FitOptions& options, const RunContext& context);

/// The same from the template's rest shape in the start's pose.
FitResult fit_from(const FitInput& input, const PlacedScan& start, const Subspace& subspace, const FitOptions& options,
                   const RunContext& context);

}  // namespace orbifit

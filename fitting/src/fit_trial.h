#pragma once

#include "orbifit/fitting/fit.h"
#include "orbifit/model/run_context.h"

#include "fit_loop.h"
#include "solver/fit_system.h"
#include "start/placed_scan.h"

namespace orbifit {

/// Runs the iterations on a system of unknowns, and fills in what they find: `pose`, `q`, `iterations`,
/// `iterations_in_all`, `stopped_because` and, where FitOptions::condition asks for it, `condition`.
/// \param state  where to begin \param first_level  of FitOptions::levels: a deformed state begins softer
void run_fit(DeformationSystem& system, FitState state, int first_level, const FitInput& input, const PlacedScan& start,
             const FitOptions& options, const RunContext& context, FitResult& result);

/// Deforms the template within a subspace, from one start, and says how well that explains the scan: all of a result
/// but `converged`, `field_residual` and what concerns the whole of a fit. State and level as in run_fit().
/// \param system  of the subspace and the input's mesh; whatever fit it has served before
FitResult fit_from(FitState state, int first_level, const FitInput& input, const PlacedScan& start, FitSystem& system,
                   const FitOptions& options, const RunContext& context);

/// The same from the template's rest shape in the start's pose.
FitResult fit_from(const FitInput& input, const PlacedScan& start, FitSystem& system, const FitOptions& options,
                   const RunContext& context);

/// Puts a fit, from a start of the same, in a result's place; what that knows of the whole stays: placements, groups,
/// regions that were left out, which scans take part, levels and all iterations, to which the new ones are added.
void take_over(FitResult found, FitResult& result);

}  // namespace orbifit

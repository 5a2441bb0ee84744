#pragma once

#include "orbifit/fitting/fit.h"
#include "orbifit/model/run_context.h"

#include "start/placed_scan.h"

namespace orbifit {

// Of the fits that explain a scan alike the simplest. Alike is what differs by less than the sensor errs: a depth
// camera's errors are shared by neighbouring points, of every width, and what is left of the narrow ones after the
// softest fit tells how large the wide ones are, which a soft template takes for shape (docs/method.md 7.1).
// Both leave a fit in mode moving as it is, and one where handles say where the template is to go.

/// Gives a fit the template's own size, where that explains the scan alike. \param start  as of `result`, with the
/// other scans' motions from there
void keep_own_size(const FitInput& input, const PlacedScan& start, const FitOptions& options, const RunContext& context,
                   FitResult& result);

/// Replaces a fit by one as stiff as can be. \param start  as before \return whether there is a stiffer one: the scan
/// then asks for no finer one either
bool keep_stiffest(const FitInput& input, const PlacedScan& start, const FitOptions& options, const RunContext& context,
                   FitResult& result);

}  // namespace orbifit

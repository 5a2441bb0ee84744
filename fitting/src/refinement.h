#pragma once

#include "orbifit/fitting/fit.h"
#include "orbifit/model/run_context.h"

#include "start/placed_scan.h"

namespace orbifit {

/// Gives a fit the template's own size, where that explains the scan alike. Then, where FitOptions::subspace does not
/// say how fine the subspace is: makes it as stiff as the scan allows (keep_stiffest()), or else fits again with finer
/// and finer subspaces, as long as the scan asks for it (docs/method.md 7.1): patches that are held out must lie nearer
/// to the finer fit, by more than chance. Each fit begins where the coarser one ended, which a finer subspace contains,
/// and is held there: what is not seen stays. The rest shape stays the template's.
/// \param start  as of `result`, of FitResult::subspace; replaced by the finest fit that was kept, with its levels
void refine(const FitInput& input, const PlacedScan& start, const FitOptions& options, const RunContext& context,
            FitResult& result);

}  // namespace orbifit

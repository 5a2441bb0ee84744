#pragma once

#include "orbifit/fitting/fit.h"
#include "orbifit/model/run_context.h"

#include "start/placed_scan.h"

namespace orbifit {

/// Compares a fit with one that keeps no group, and fills in `groups`. Where FitOptions::drop_unsupported asks for it,
/// fits anew without the regions whose groups disagree, from the same start, until none of those left does: then
/// `result` is the last such fit, and `dropped` names what was left out.
void judge_groups(const FitInput& input, const PlacedScan& start, const FitOptions& options, const RunContext& context,
                  FitResult& result);

}  // namespace orbifit

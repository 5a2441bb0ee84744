#pragma once

#include <vector>

#include "orbifit/fitting/fit.h"
#include "orbifit/model/run_context.h"

#include "start/placed_scan.h"

namespace orbifit {

/// Compares a fit with one that keeps no group. \param fitted, annotation  of the fit, see FitResult
std::vector<GroupAgreement> judged_groups(const Mesh& fitted, const SymmetryAnnotation& annotation,
                                          const FitInput& input, const PlacedScan& start, const FitOptions& options,
                                          const RunContext& context);

/// Fills in a fit's `groups` by judged_groups(), and fits anew without the regions whose groups disagree, from the same
/// start, until none of those left does: then `result` is the last such fit, and `dropped` names what was left out.
void drop_unsupported(const FitInput& input, const PlacedScan& start, const FitOptions& options,
                      const RunContext& context, FitResult& result);

}  // namespace orbifit

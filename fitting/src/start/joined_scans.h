#pragma once

#include "orbifit/fitting/fit.h"
#include "orbifit/model/run_context.h"

#include "start/placed_scan.h"

namespace orbifit {

/// One start for all scans of an input, after a fit to the first one alone: the fitted shape is found in each other
/// scan, at the first one's scale, and brings it into the first one's frame. Of each scan, what is not the shape's is
/// taken away by itself. A scan in which the shape is not found is named in a message and left out.
/// \param start  of the first scan alone; its pose is kept \param fitted  what it led to
PlacedScan join_scans(const FitInput& input, const PlacedScan& start, const FitResult& fitted,
                      const FitOptions& options, const RunContext& context);

}  // namespace orbifit

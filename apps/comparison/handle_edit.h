#pragma once

#include "orbifit/fitting/fit.h"
#include "orbifit/model/run_context.h"

namespace orbifit {

/// Our edit by handles alone (Deformer), told as a fit so that it can stand beside others. The pose stays as given; of
/// the options only the subspace and `condition` matter.
FitResult edit_by_handles(const FitInput& input, const FitOptions& options, const RunContext& context);

}  // namespace orbifit

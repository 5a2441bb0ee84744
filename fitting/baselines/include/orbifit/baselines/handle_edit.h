#pragma once

#include "orbifit/fitting/fit.h"
#include "orbifit/model/run_context.h"

namespace orbifit {

/// Our edit by handles alone (Deformer; paper, section 6, with alpha 100 and ten iterations), told as a fit so that it
/// can stand beside others. The pose stays as given; of the options only the subspace matters. Times: "prepare", "fit".
/// \throw InputError without handles
FitResult edit_by_handles(const FitInput& input, const FitOptions& options, const RunContext& context);

}  // namespace orbifit

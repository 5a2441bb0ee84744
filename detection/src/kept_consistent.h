#pragma once

#include "orbifit/detection/explanation.h"
#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

namespace orbifit {

/// What every subspace can keep of what was found, largest regions first, numbered in that order. What is left out is
/// told in one message, and each with its reason in `explanation` (may be null). See consistent_annotation().
SymmetryAnnotation kept_consistent(const Mesh& mesh, const SymmetryAnnotation& found, Explanation* explanation,
                                   const RunContext& context);

}  // namespace orbifit

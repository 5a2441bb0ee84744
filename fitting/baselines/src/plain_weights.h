#pragma once

#include "orbifit/subspace/subspace.h"

#include "basis/lift.h"

namespace orbifit {

/// The weights, #V by #S, by which the samples' displacements make those of the vertices (paper, section 5).
/// \pre the subspace's lift is the paper's
LiftWeights plain_weights(const Subspace& subspace);

}  // namespace orbifit

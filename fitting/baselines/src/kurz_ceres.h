#pragma once

#include "kurz_terms.h"

namespace orbifit {

/// The minimum of KurzTerms' energy by Ceres, residual by residual with analytic Jacobians, as KurzNormal finds it from
/// products made once: independent of those, and slower. Rotations stay. \throw NoResultError when Ceres finds none
void solve_with_ceres(const KurzTerms& terms, const DataTerm& data, KurzState& state);

}  // namespace orbifit

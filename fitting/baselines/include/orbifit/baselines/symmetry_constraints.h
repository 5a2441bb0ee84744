#pragma once

#include <Eigen/SparseCore>

#include "orbifit/subspace/subspace.h"

namespace orbifit {

/// C: what the symmetries ask of the samples' displacements u and of the translations t that carry the groups (none in
/// mode fixed) is C (u, t) = 0, with u stacked x0 y0 z0 x1 ... Three rows each for
///   - a sample against its orbit's seed: u(g x) = O u(x) + (I - O) t (paper, equation 2), g the product of elements
///     that leads there; with t summed over the groups that g passes through,
///   - two ways from a seed to one place, which must agree,
///   - what vertices bound to a place ask of t alone.
/// Rows may depend on one another.
/// \return 3 #constraints by 3 (#S + #carriers)
Eigen::SparseMatrix<double> symmetry_constraints(const Subspace& subspace);

}  // namespace orbifit

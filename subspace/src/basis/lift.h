#pragma once

#include <Eigen/SparseCore>

#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

namespace orbifit {

/// Row p: the weights w_pl / sum over l of w_pl by which the samples' displacements make that of point p.
using LiftWeights = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// Partition of unity of Gaussians of standard deviation `sigma` about the samples (paper, section 5, "Lifting the
/// displacements"). The paper cuts a Gaussian off where it falls below 0.001; here 0.001 is subtracted as well, so that
/// the field is continuous. A point that no sample reaches follows the nearest one.
/// \param points  #P by 3
/// \param samples #S by 3, S >= 1
/// \return #P by #S; non-negative, rows sum to 1. O(P log S), about 60 non-zeros a row for sigma = r.
LiftWeights lift_weights(const Points& points, const Points& samples, double sigma, const RunContext& context);

}  // namespace orbifit

#pragma once

#include <Eigen/SparseCore>

#include "grid_field.h"

namespace orbifit {

/// K with c^T K c = the integral over the grid's cells of the squared Hessian of sum_i c_i b_i, nodes by nodes. Exact
/// for cubic B-splines; for hats, which have no Hessian, by finite differences at the nodes. Zero for affine functions
/// alone.
Eigen::SparseMatrix<double> thin_plate(const Grid& grid);

/// Rows R with R^T R = thin_plate().
SparseRows thin_plate_rows(const Grid& grid);

}  // namespace orbifit

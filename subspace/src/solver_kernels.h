#pragma once

#include <Eigen/Core>

namespace orbifit {

/// sum[0 ... 11] = sum over e < count of q[column[e]] * blocks[12 e ...].
void gather_blocks(const double* blocks, const int* column, int count, const double* q, double* sum);

/// Solves L L^T x = b in place; L lower triangular, column-major.
void cholesky_solve(const Eigen::MatrixXd& lower, Eigen::VectorXd& x);

}  // namespace orbifit

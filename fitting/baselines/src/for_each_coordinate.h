#pragma once

#include <Eigen/SparseCore>

namespace orbifit {

/// The lower half of K (x) I_3, K a symmetric matrix of the samples, as the first rows and columns of a matrix of more
/// unknowns.
Eigen::SparseMatrix<double> lower_for_each_coordinate(const Eigen::SparseMatrix<double>& scalar, Eigen::Index unknowns);

}  // namespace orbifit

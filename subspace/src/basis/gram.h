#pragma once

#include <Eigen/Core>

namespace orbifit {

using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// The least multiple of four that is not less: as many columns as a matrix for lower_gram() needs.
constexpr Eigen::Index whole_fours(Eigen::Index columns) {
  return (columns + 3) / 4 * 4;
}

/// The lower half of rows^T rows; what it leaves above the diagonal means nothing. Its size becomes the columns'
/// number. \pre the columns' number is a multiple of four: fill up with zeros
void lower_gram(const RowMajorMatrix& rows, Eigen::MatrixXd& result);

}  // namespace orbifit

#pragma once

#include <vector>

#include <Eigen/Core>

#include "deformation/corotation.h"

namespace orbifit {

/// Rows of three numbers, one a column, and matrices of three columns, one a column, in fours of which the last are 0:
/// processors take four at once.
using FourRows = Eigen::Matrix<double, 4, Eigen::Dynamic>;
using FourMatrices = Eigen::Matrix<double, 12, Eigen::Dynamic>;

FourRows in_fours(const Points& rows);
FourMatrices in_fours(const std::vector<Eigen::Matrix3d>& matrices);

/// Sums over the neighbours j of a sample i, of the edges e = x_i - x_j at rest.
class NeighbourSums {
 public:
  explicit NeighbourSums(const Corotation& corotation);

  /// sum of (y_j - y_i) (x_j - x_i)^T, y = x + u. \param displacements u of all samples
  Eigen::Matrix3d covariance(int sample, const FourRows& displacements) const;

  /// sum of (R_i + R_j) / 2 e - e. \param rotations R of all samples
  Eigen::Vector3d turned(int sample, const FourMatrices& rotations) const;

  /// sum of |e + u_i - u_j - (R_i + R_j) / 2 e|^2
  double squared_residual(int sample, const FourMatrices& rotations, const FourRows& displacements) const;

  /// sum of |e|^2
  double size(int sample) const { return sizes_[static_cast<std::size_t>(sample)]; }

 private:
  int count(std::size_t i) const { return first_[i + 1] - first_[i]; }

  FourRows edges_;          // e, sample by sample
  std::vector<int> first_;  // of each sample's edges, and their number at the end
  std::vector<int> end_;    // j of each edge
  FourRows sums_;           // of each sample's edges
  std::vector<double> sizes_;
  std::vector<Eigen::Matrix3d> rest_;  // covariances
};

}  // namespace orbifit

#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace orbifit {

/// How far an edit goes at most (docs/method.md 2.2): a coordinate with which handles hardly move would meet their last
/// digit by going anywhere. What would go farther is held, each coordinate by weight(): as least squares over
/// coordinates z leave weight |z|^2 at most what the energy is at z = 0, the samples' displacements columns z, 3#S by
/// DoF times DoF, stay within reach.
class BoundedEdit {
 public:
  /// \param diagonal  of the mesh
  /// \param targets  displacements that the handles ask for, mesh units, stacked x0 y0 z0 x1 ...
  BoundedEdit(double diagonal, const Eigen::VectorXd& targets);

  /// Whether the coordinates are farther from 0, and take some sample farther. O(DoF) where the first does not hold.
  bool exceeded(const Eigen::SparseMatrix<double>& columns, const Eigen::VectorXd& coordinates) const;

  /// What each coordinate's square is to weigh: O(nonzeros of `columns`).
  /// \param energy  at the coordinates 0, of the least squares to which the weight is added
  double weight(const Eigen::SparseMatrix<double>& columns, double energy) const;

 private:
  double reach_;  // mesh units
};

}  // namespace orbifit

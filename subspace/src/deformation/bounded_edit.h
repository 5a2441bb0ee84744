#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace orbifit {

/// How far an edit goes at most: where two handles nearly let a sample go, that meets their last digit by going
/// anywhere. What would go farther is held, each coordinate by weight(): as least squares over coordinates z leave
/// weight |z|^2 at most what the energy is at z = 0, the samples' displacements columns z stay within reach.
class BoundedEdit {
 public:
  /// \param diagonal  of the mesh
  /// \param targets  displacements that the handles ask for
  BoundedEdit(double diagonal, const Eigen::VectorXd& targets);

  /// Whether the coordinates are farther from 0, and take some sample farther. O(DoF) where the first does not hold.
  bool exceeded(const Eigen::SparseMatrix<double>& columns, const Eigen::VectorXd& coordinates) const;

  /// \param energy  at the coordinates 0
  double weight(const Eigen::SparseMatrix<double>& columns, double energy) const;

 private:
  double reach_;  // mesh units
};

}  // namespace orbifit

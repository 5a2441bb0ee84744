#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

namespace orbifit {

/// Solves (A + B B^T) x = b for a sparse symmetric A, positive definite, and a B of few columns, which would make it
/// dense: sparse Cholesky of A bordered by B (Vanderbei 1995: quasi-definite, so that any order of elimination will
/// do), in an order of little fill (Amestoy, Davis, Duff 1996). The solution is refined. On a surface's A the cost
/// grows about linearly with its size.
class NormalSolver {
 public:
  /// \param lower  A's lower half \param few  B, as many rows
  /// \return whether it could be factorised
  bool compute(const Eigen::SparseMatrix<double>& lower, const Eigen::MatrixXd& few);

  /// \pre compute()
  Eigen::VectorXd solve(const Eigen::VectorXd& side) const;
  Eigen::VectorXd multiply(const Eigen::VectorXd& x) const;

  Eigen::Index size() const { return lower_.cols(); }

 private:
  Eigen::VectorXd solve_once(const Eigen::VectorXd& side) const;

  Eigen::SparseMatrix<double> lower_;
  Eigen::MatrixXd few_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower> factor_;
};

}  // namespace orbifit

#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "deformation/symmetric_factor.h"

namespace orbifit {

/// Solves (A + B B^T) x = b for a sparse symmetric A, positive definite, and a B of few columns, which would make it
/// dense: by A's factor and the matrix between the columns (Woodbury 1950). The solution is refined. On a surface's A
/// the cost grows about linearly with its size.
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
  Eigen::VectorXd solve_once(Eigen::VectorXd side) const;

  Eigen::SparseMatrix<double> lower_;
  SymmetricFactor factor_;               // of A
  Eigen::MatrixXd few_;                  // B
  Eigen::MatrixXd solved_few_;           // A^-1 B
  Eigen::LLT<Eigen::MatrixXd> between_;  // I + B^T A^-1 B
};

}  // namespace orbifit

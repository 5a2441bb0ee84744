#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "deformation/elimination_fronts.h"

namespace orbifit {

/// The Cholesky factor of a sparse symmetric positive definite matrix, by the multifrontal method (Duff and Reid 1983;
/// Liu 1992): columns that have their entries in nearly the same rows are eliminated together, as dense matrices.
class SupernodalFactor {
 public:
  /// Finds the order of elimination. O(entries()) \param lower  a matrix of the pattern to come: its lower half, with
  /// all of its diagonal
  void analyse(const Eigen::SparseMatrix<double>& lower);

  /// Of the factor, those included that its fronts hold and that stay zero.
  double entries() const { return static_cast<double>(entries_); }

  /// \pre analyse() of the same pattern \return false where it is not positive definite
  bool factorise(const Eigen::SparseMatrix<double>& lower);

  /// Solves in place. O(entries()) \pre factorise()
  void solve(Eigen::VectorXd& side) const;

 private:
  Eigen::Map<Eigen::MatrixXd> columns(std::size_t front);
  Eigen::Map<const Eigen::MatrixXd> columns(std::size_t front) const;

  EliminationFronts elimination_;
  std::vector<std::size_t> begin_;  // of each front's columns in values_
  std::size_t entries_ = 0;
  std::vector<double> values_;  // of each front, column-major: its own rows, then those below
};

}  // namespace orbifit

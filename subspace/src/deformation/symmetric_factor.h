#pragma once

#include <memory>

#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace orbifit {

class SupernodalFactor;

/// The Cholesky factor of a symmetric positive definite matrix: sparse where most of it stays zero, as that of Laplace
/// matrices does where every sample has coordinates of its own, else dense. Solves need no memory of their own but,
/// where it is sparse, two vectors.
class SymmetricFactor {
 public:
  SymmetricFactor();
  ~SymmetricFactor();
  SymmetricFactor(SymmetricFactor&&) noexcept;
  SymmetricFactor& operator=(SymmetricFactor&&) noexcept;

  /// \param lower  the matrix' lower half; above it all is zero
  /// \return false where it is not positive definite
  bool factorise(const Eigen::SparseMatrix<double>& lower);

  bool is_sparse() const { return sparse_ != nullptr; }

  /// Solves in place.
  void solve(Eigen::VectorXd& side) const;

 private:
  std::unique_ptr<SupernodalFactor> sparse_;
  Eigen::MatrixXd dense_;  // lower
};

}  // namespace orbifit

#pragma once

#include <memory>

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

namespace orbifit {

/// Linear systems A x = b, or the minimum of x^T A x / 2 - b^T x where C x = 0, by Lagrange multipliers:
///     | A  C^T | x |   | b |
///     | C   0  | l | = | 0 |.
/// A is symmetric, sparse and positive definite but for a border of few last rows and columns, which C does not touch.
/// Rows of C may depend on one another, so the multipliers' block gets a small -1/w. With it they can be eliminated,
/// which leaves A + w C^T C to factorise, and iterative refinement takes the effect of w out again, to rounding (the
/// method of multipliers: Hestenes 1969, Powell 1969).
class SaddleSystem {
 public:
  using Sparse = Eigen::SparseMatrix<double>;

  /// \param constraints C, any number of rows
  explicit SaddleSystem(Sparse constraints);
  ~SaddleSystem();
  SaddleSystem(SaddleSystem&&) noexcept;

  /// \param lower  lower half of A without its border, n by n; while its pattern stays, so does the symbolic analysis
  /// \param border n by k \param corner k by k
  /// \throw NoResultError where it is not positive definite to rounding
  void factorise(const Sparse& lower, const Eigen::MatrixXd& border, const Eigen::MatrixXd& corner);

  /// \param right n + k \return x, n + k
  Eigen::VectorXd solve(const Eigen::VectorXd& right) const;

  /// Estimate of the condition number, of the whole matrix with C on its range where there are constraints.
  double condition() const;

 private:
  struct Factor;
  struct Pair {
    Eigen::VectorXd x, multipliers;
  };
  Pair solve(const Eigen::VectorXd& right, const Eigen::VectorXd& of_constraints) const;
  Eigen::VectorXd multiply(const Eigen::VectorXd& x) const;  // by A
  Eigen::VectorXd eliminate(const Eigen::VectorXd& right) const;
  void prepare_border();
  using RangeFactor = Eigen::SimplicialLDLT<Sparse, Eigen::Lower>;
  Eigen::VectorXd in_range(const Eigen::VectorXd& of_constraints, const RangeFactor& factor) const;

  Sparse constraints_;
  Sparse gram_;  // lower half of C^T C
  Sparse matrix_;
  Eigen::MatrixXd border_, corner_, reduced_border_, reduced_corner_;
  double weight_ = 0;
  std::unique_ptr<Factor> factor_;
};

}  // namespace orbifit

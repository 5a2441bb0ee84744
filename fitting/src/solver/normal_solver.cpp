#include "solver/normal_solver.h"

namespace orbifit {

namespace {

using Eigen::Index;
using Eigen::VectorXd;

// | A   B |
// | B^T -1 |, lower half
Eigen::SparseMatrix<double> bordered(const Eigen::SparseMatrix<double>& lower, const Eigen::MatrixXd& few) {
  const Index size = lower.cols();
  const Index all = size + few.cols();
  Eigen::SparseMatrix<double> result(all, all);
  result.reserve(lower.nonZeros() + few.size() + few.cols());
  for (Index j = 0; j < size; ++j) {
    result.startVec(j);
    for (Eigen::SparseMatrix<double>::InnerIterator entry(lower, j); entry; ++entry) {
      result.insertBack(entry.row(), j) = entry.value();
    }
    for (Index k = 0; k < few.cols(); ++k) {
      if (few(j, k) != 0) result.insertBack(size + k, j) = few(j, k);
    }
  }
  for (Index k = size; k < all; ++k) {
    result.startVec(k);
    result.insertBack(k, k) = -1;
  }
  result.finalize();
  return result;
}

}  // namespace

bool NormalSolver::compute(const Eigen::SparseMatrix<double>& lower, const Eigen::MatrixXd& few) {
  lower_ = lower;
  few_ = few;
  factor_.compute(bordered(lower_, few_));
  return factor_.info() == Eigen::Success;
}

VectorXd NormalSolver::solve_once(const VectorXd& side) const {
  VectorXd all = VectorXd::Zero(size() + few_.cols());
  all.head(size()) = side;
  return factor_.solve(all).head(size());
}

VectorXd NormalSolver::solve(const VectorXd& side) const {
  constexpr int kRefinements = 3;  // what A alone leaves open costs digits, which two or three give back
  VectorXd x = solve_once(side);
  double before = (side - multiply(x)).norm();
  for (int step = 0; step < kRefinements && before > 0; ++step) {
    const VectorXd better = x + solve_once(side - multiply(x));
    const double now = (side - multiply(better)).norm();
    if (!(now < before)) break;
    x = better;
    before = now;
  }
  return x;
}

VectorXd NormalSolver::multiply(const VectorXd& x) const {
  VectorXd result = lower_.selfadjointView<Eigen::Lower>() * x;
  result.noalias() += few_ * (few_.transpose() * x);
  return result;
}

}  // namespace orbifit

#include "solver/normal_solver.h"

namespace orbifit {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

bool NormalSolver::compute(const Eigen::SparseMatrix<double>& lower, const MatrixXd& few) {
  lower_ = lower;
  few_ = few;
  if (!factor_.factorise(lower_)) return false;
  solved_few_ = few_;
  VectorXd column;
  for (Index k = 0; k < few_.cols(); ++k) {
    column = few_.col(k);
    factor_.solve(column);
    solved_few_.col(k) = column;
  }
  between_.compute(MatrixXd::Identity(few_.cols(), few_.cols()) + few_.transpose() * solved_few_);
  return between_.info() == Eigen::Success;
}

VectorXd NormalSolver::solve_once(VectorXd side) const {
  factor_.solve(side);
  if (few_.cols() > 0) side -= solved_few_ * between_.solve(few_.transpose() * side);
  return side;
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

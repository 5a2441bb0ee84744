#include "deformation/bounded_edit.h"

#include <algorithm>
#include <cmath>

namespace orbifit {

namespace {

// Of the diagonal, or of what the handles ask for if that is more: what nobody means, and no shape is left of.
constexpr double kReach = 100;

// The largest norm of a row: displacement by coordinates.
double largest_row(const Eigen::SparseMatrix<double>& columns) {
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(columns.rows());
  for (Eigen::Index j = 0; j < columns.outerSize(); ++j) {
    for (Eigen::SparseMatrix<double>::InnerIterator entry(columns, j); entry; ++entry) {
      squares[entry.row()] += entry.value() * entry.value();
    }
  }
  return squares.size() > 0 ? std::sqrt(squares.maxCoeff()) : 0;
}

}  // namespace

BoundedEdit::BoundedEdit(double diagonal, const Eigen::VectorXd& targets)
    : reach_(kReach * std::max(diagonal, targets.size() > 0 ? targets.cwiseAbs().maxCoeff() : 0)) {}

bool BoundedEdit::exceeded(const Eigen::SparseMatrix<double>& columns, const Eigen::VectorXd& coordinates) const {
  if (coordinates.size() == 0 || coordinates.norm() <= reach_) return false;
  return (columns * coordinates).cwiseAbs().maxCoeff() > reach_;
}

double BoundedEdit::weight(const Eigen::SparseMatrix<double>& columns, double energy) const {
  const double row = largest_row(columns);
  return energy * row * row / (reach_ * reach_);
}

}  // namespace orbifit

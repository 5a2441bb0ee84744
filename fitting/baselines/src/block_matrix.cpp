#include "block_matrix.h"

#include <algorithm>

#include <Eigen/CholmodSupport>

#include "solver/condition.h"

namespace orbifit {

using Sparse = Eigen::SparseMatrix<double>;

struct BlockMatrix::Solver {
  Eigen::CholmodSupernodalLLT<Sparse, Eigen::Lower> cholesky;
};

BlockMatrix::BlockMatrix(const Sparse& pattern) : solver_(std::make_unique<Solver>()) {
  const auto columns = static_cast<int>(pattern.cols());
  for (int j = 0; j < columns; ++j) {
    first_.push_back(static_cast<int>(rows_.size()));
    rows_.push_back(j);
    for (Sparse::InnerIterator each(pattern, j); each; ++each) {
      if (each.row() > j) rows_.push_back(static_cast<int>(each.row()));
    }
  }
  first_.push_back(static_cast<int>(rows_.size()));
  blocks_.assign(rows_.size(), Eigen::Matrix3d::Zero());
  scalars_.resize(3 * columns, 3 * columns);
  Eigen::VectorXi counts(3 * columns);
  for (int j = 0; j < columns; ++j) {
    const auto column = static_cast<std::size_t>(j);
    for (int c = 0; c < 3; ++c) counts[3 * j + c] = 3 * (first_[column + 1] - first_[column]) - c;
  }
  scalars_.reserve(counts);
  for (int j = 0; j < columns; ++j) {
    for (int c = 0; c < 3; ++c) {
      for (int b = first_[static_cast<std::size_t>(j)]; b < first_[static_cast<std::size_t>(j) + 1]; ++b) {
        const int row = 3 * rows_[static_cast<std::size_t>(b)];
        for (int r = row == 3 * j ? c : 0; r < 3; ++r) scalars_.insert(row + r, 3 * j + c) = 0;
      }
    }
  }
  scalars_.makeCompressed();
  cholmod_common& common = solver_->cholesky.cholmod();
  common.print = 0;
  // The better of both: symmetries link far parts of a grid, so neither always is.
  common.nmethods = 2;
  common.method[0].ordering = CHOLMOD_AMD;
  common.method[1].ordering = CHOLMOD_METIS;
  solver_->cholesky.analyzePattern(scalars_);
}

BlockMatrix::~BlockMatrix() = default;
BlockMatrix::BlockMatrix(BlockMatrix&&) noexcept = default;

std::size_t BlockMatrix::place(int row, int column) const {
  const auto begin = rows_.begin() + first_[static_cast<std::size_t>(column)];
  const auto end = rows_.begin() + first_[static_cast<std::size_t>(column) + 1];
  return static_cast<std::size_t>(std::lower_bound(begin, end, row) - rows_.begin());
}

void BlockMatrix::add(int row, int column, const Eigen::Matrix3d& block) {
  if (row >= column) {
    blocks_[place(row, column)] += block;
  } else {
    blocks_[place(column, row)] += block.transpose();
  }
}

void BlockMatrix::add_product(const Sparse& scalars, const Eigen::Matrix3d& factor, bool both) {
  for (int j = 0; j < scalars.outerSize(); ++j) {
    for (Sparse::InnerIterator each(scalars, j); each; ++each) {
      const auto i = static_cast<int>(each.row());
      if (both && i == j) {
        blocks_[place(j, j)] += each.value() * (factor + factor.transpose());
      } else if (both || i >= j) {
        add(i, j, each.value() * factor);
      }
    }
  }
}

void BlockMatrix::fill() {
  double* to = scalars_.valuePtr();
  for (std::size_t j = 0; j + 1 < first_.size(); ++j) {
    const auto begin = static_cast<std::size_t>(first_[j]);
    const auto end = static_cast<std::size_t>(first_[j + 1]);
    for (int c = 0; c < 3; ++c) {
      for (std::size_t b = begin; b < end; ++b) {
        for (int r = b == begin ? c : 0; r < 3; ++r) *to++ = blocks_[b](r, c);
      }
    }
  }
}

bool BlockMatrix::factorise() {
  fill();
  solver_->cholesky.factorize(scalars_);
  return solver_->cholesky.info() == Eigen::Success;
}

Eigen::VectorXd BlockMatrix::solve(const Eigen::VectorXd& right) const {
  return solver_->cholesky.solve(right);
}

double BlockMatrix::condition() const {
  return condition_estimate(
      scalars_.cols(),
      [&](const Eigen::VectorXd& x) -> Eigen::VectorXd { return scalars_.selfadjointView<Eigen::Lower>() * x; },
      [&](const Eigen::VectorXd& x) { return solve(x); });
}

}  // namespace orbifit

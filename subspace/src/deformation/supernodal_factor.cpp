#include "deformation/supernodal_factor.h"

#include <algorithm>
#include <cstddef>

#include <Eigen/Cholesky>

namespace orbifit {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;
using Block = Eigen::Map<MatrixXd>;
using ConstBlock = Eigen::Map<const MatrixXd>;

Index height(const EliminationFront& front) {
  return front.width + static_cast<Index>(front.rows.size());
}

// One factorisation: front after front, what each leaves for those above kept on a stack.
class Elimination {
 public:
  Elimination(const EliminationFronts& elimination, const Sparse& lower)
      : fronts_(elimination.fronts),
        matrix_(lower.rows(), lower.cols()),
        place_(static_cast<std::size_t>(lower.rows())) {
    matrix_.selfadjointView<Eigen::Lower>() = lower.selfadjointView<Eigen::Lower>().twistedBy(elimination.order);
    Index highest = 0;
    for (const EliminationFront& front : fronts_) highest = std::max(highest, height(front));
    work_.resize(static_cast<std::size_t>(highest * highest));
  }

  // \param columns  written: the front's columns of the factor
  bool eliminate(const EliminationFront& front, Block columns) {
    const Index below = static_cast<Index>(front.rows.size());
    Block all(work_.data(), height(front), height(front));
    assemble(front, all);
    Eigen::Ref<MatrixXd> own = all.topLeftCorner(front.width, front.width);
    if (Eigen::LLT<Eigen::Ref<MatrixXd>>(own).info() != Eigen::Success) return false;
    if (!(own.diagonal().array() > 0).all()) return false;
    auto rest = all.bottomLeftCorner(below, front.width);
    if (below > 0) {
      own.triangularView<Eigen::Lower>().transpose().solveInPlace<Eigen::OnTheRight>(rest);
      all.bottomRightCorner(below, below).selfadjointView<Eigen::Lower>().rankUpdate(rest, -1.0);
    }
    columns = all.leftCols(front.width);
    pop(front);
    push(all.bottomRightCorner(below, below));
    return true;
  }

 private:
  // What the matrix has in the front's columns, and what its children leave.
  void assemble(const EliminationFront& front, Block& all) {
    for (Index j = 0; j < all.cols(); ++j) all.col(j).tail(all.rows() - j).setZero();
    for (int i = 0; i < front.width; ++i) place_[static_cast<std::size_t>(front.first + i)] = i;
    for (std::size_t i = 0; i < front.rows.size(); ++i) {
      place_[static_cast<std::size_t>(front.rows[i])] = front.width + static_cast<int>(i);
    }
    for (int j = 0; j < front.width; ++j) {
      for (Sparse::InnerIterator entry(matrix_, front.first + j); entry; ++entry) {
        all(place_[static_cast<std::size_t>(entry.index())], j) += entry.value();
      }
    }
    std::size_t end = stack_.size();
    for (auto child = front.children.rbegin(); child != front.children.rend(); ++child) {
      const std::vector<int>& rows = fronts_[static_cast<std::size_t>(*child)].rows;
      end -= rows.size() * rows.size();
      add(rows, stack_.data() + end, all);
    }
  }

  void add(const std::vector<int>& rows, const double* left, Block& all) {
    target_.resize(rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) target_[i] = place_[static_cast<std::size_t>(rows[i])];
    for (std::size_t j = 0; j < rows.size(); ++j, left += rows.size()) {
      double* const column = all.data() + target_[j] * all.rows();
      for (std::size_t i = j; i < rows.size(); ++i) column[target_[i]] += left[i];
    }
  }

  void pop(const EliminationFront& front) {
    std::size_t count = 0;
    for (const int child : front.children) {
      const std::size_t rows = fronts_[static_cast<std::size_t>(child)].rows.size();
      count += rows * rows;
    }
    stack_.resize(stack_.size() - count);
  }

  void push(const Eigen::Ref<const MatrixXd>& left) {
    const std::size_t begin = stack_.size();
    stack_.resize(begin + static_cast<std::size_t>(left.size()));
    Block(stack_.data() + begin, left.rows(), left.cols()).triangularView<Eigen::Lower>() = left;
  }

  const std::vector<EliminationFront>& fronts_;
  Sparse matrix_;           // in the order of elimination, lower half
  std::vector<int> place_;  // of a row in the front, where it has it
  std::vector<int> target_;
  std::vector<double> work_, stack_;
};

}  // namespace

void SupernodalFactor::analyse(const Sparse& lower) {
  elimination_ = elimination_fronts(lower);
  begin_.clear();
  entries_ = 0;
  for (const EliminationFront& front : elimination_.fronts) {
    begin_.push_back(entries_);
    entries_ += static_cast<std::size_t>(height(front) * front.width);
  }
}

Block SupernodalFactor::columns(std::size_t front) {
  const EliminationFront& of = elimination_.fronts[front];
  return {values_.data() + begin_[front], height(of), of.width};
}

ConstBlock SupernodalFactor::columns(std::size_t front) const {
  const EliminationFront& of = elimination_.fronts[front];
  return {values_.data() + begin_[front], height(of), of.width};
}

bool SupernodalFactor::factorise(const Sparse& lower) {
  values_.resize(entries_);
  Elimination run(elimination_, lower);
  for (std::size_t f = 0; f < elimination_.fronts.size(); ++f) {
    if (!run.eliminate(elimination_.fronts[f], columns(f))) return false;
  }
  return true;
}

void SupernodalFactor::solve(VectorXd& side) const {
  if (side.size() == 0) return;
  VectorXd ordered = elimination_.order * side;
  VectorXd below;
  for (std::size_t f = 0; f < elimination_.fronts.size(); ++f) {
    const EliminationFront& front = elimination_.fronts[f];
    const ConstBlock all = columns(f);
    auto own = ordered.segment(front.first, front.width);
    all.topRows(front.width).triangularView<Eigen::Lower>().solveInPlace(own);
    below.noalias() = all.bottomRows(static_cast<Index>(front.rows.size())) * own;
    for (std::size_t i = 0; i < front.rows.size(); ++i) ordered[front.rows[i]] -= below[static_cast<Index>(i)];
  }
  for (std::size_t f = elimination_.fronts.size(); f-- > 0;) {
    const EliminationFront& front = elimination_.fronts[f];
    const ConstBlock all = columns(f);
    auto own = ordered.segment(front.first, front.width);
    below.resize(static_cast<Index>(front.rows.size()));
    for (std::size_t i = 0; i < front.rows.size(); ++i) below[static_cast<Index>(i)] = ordered[front.rows[i]];
    own.noalias() -= all.bottomRows(below.size()).transpose() * below;
    all.topRows(front.width).triangularView<Eigen::Lower>().transpose().solveInPlace(own);
  }
  side = elimination_.order.transpose() * ordered;
}

}  // namespace orbifit

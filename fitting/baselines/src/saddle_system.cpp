#include "saddle_system.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <Eigen/CholmodSupport>
#include <Eigen/LU>

#include "orbifit/model/errors.h"

#include "solver/condition.h"

namespace orbifit {

namespace {

using Eigen::VectorXd;

constexpr double kWeight = 1e3;  // of C^T C, relative to the mean of A's diagonal
// What no constraint holds, nor A (groups carried along their axes), still gives a positive pivot; refinement takes
// this out again. Relative to w C^T C.
constexpr double kShift = 1e-10;
constexpr double kConverged = 1e-15;  // of the solution: refinement stops at smaller steps,
constexpr int kMaxSteps = 30;
constexpr double kSlowest = 0.5;  // or when they no longer shrink by this

}  // namespace

struct SaddleSystem::Factor {
  Eigen::CholmodSupernodalLLT<Sparse, Eigen::Lower> cholesky;
  std::vector<int> starts, rows;  // the pattern that was analysed

  bool analysed(const Sparse& matrix) const {
    return std::equal(starts.begin(), starts.end(), matrix.outerIndexPtr(),
                      matrix.outerIndexPtr() + matrix.outerSize() + 1) &&
           std::equal(rows.begin(), rows.end(), matrix.innerIndexPtr(), matrix.innerIndexPtr() + matrix.nonZeros());
  }

  void analyse(const Sparse& matrix) {
    cholesky.cholmod().print = 0;
    cholesky.analyzePattern(matrix);
    starts.assign(matrix.outerIndexPtr(), matrix.outerIndexPtr() + matrix.outerSize() + 1);
    rows.assign(matrix.innerIndexPtr(), matrix.innerIndexPtr() + matrix.nonZeros());
  }
};

SaddleSystem::SaddleSystem(Sparse constraints)
    : constraints_(std::move(constraints)), factor_(std::make_unique<Factor>()) {
  const Sparse gram = constraints_.transpose() * constraints_;
  gram_ = gram.triangularView<Eigen::Lower>();
}

SaddleSystem::~SaddleSystem() = default;
SaddleSystem::SaddleSystem(SaddleSystem&&) noexcept = default;

void SaddleSystem::factorise(const Sparse& lower, const Eigen::MatrixXd& border, const Eigen::MatrixXd& corner) {
  matrix_ = lower;
  border_ = border;
  corner_ = corner;
  weight_ = kWeight * matrix_.diagonal().mean();
  Sparse system = matrix_;
  if (constraints_.rows() > 0) {
    system += weight_ * gram_;
    const VectorXd shift = kShift * weight_ * gram_.diagonal();
    system += Sparse(shift.asDiagonal());
  }
  system.makeCompressed();
  if (!factor_->analysed(system)) factor_->analyse(system);
  factor_->cholesky.factorize(system);
  if (factor_->cholesky.info() != Eigen::Success) {
    throw NoResultError("the system on the full sampling is not positive definite to rounding");
  }
  prepare_border();
}

void SaddleSystem::prepare_border() {
  if (border_.cols() == 0) return;
  reduced_border_ = factor_->cholesky.solve(border_);
  reduced_corner_ = corner_ - border_.transpose() * reduced_border_;
}

VectorXd SaddleSystem::multiply(const VectorXd& x) const {
  const Eigen::Index n = matrix_.cols();
  VectorXd result(x.size());
  result.head(n) = matrix_.selfadjointView<Eigen::Lower>() * x.head(n);
  if (border_.cols() == 0) return result;
  result.head(n) += border_ * x.tail(border_.cols());
  result.tail(border_.cols()) = border_.transpose() * x.head(n) + corner_ * x.tail(border_.cols());
  return result;
}

// By A + w C^T C: block elimination of what is sparse.
VectorXd SaddleSystem::eliminate(const VectorXd& right) const {
  const Eigen::Index n = matrix_.cols();
  const Eigen::Index k = border_.cols();
  VectorXd result(n + k);
  result.head(n) = factor_->cholesky.solve(VectorXd(right.head(n)));
  if (k == 0) return result;
  result.tail(k) = reduced_corner_.fullPivLu().solve(right.tail(k) - border_.transpose() * result.head(n));
  result.head(n) -= reduced_border_ * result.tail(k);
  return result;
}

SaddleSystem::Pair SaddleSystem::solve(const VectorXd& right, const VectorXd& of_constraints) const {
  const Eigen::Index n = matrix_.cols();
  Pair result{VectorXd::Zero(right.size()), VectorXd::Zero(constraints_.rows())};
  double last = 0;
  for (int step = 0; step < kMaxSteps; ++step) {
    const VectorXd missed = of_constraints - constraints_ * result.x.head(n);
    VectorXd side = right - multiply(result.x);
    side.head(n) += constraints_.transpose() * (weight_ * missed - result.multipliers);
    const VectorXd change = eliminate(side);
    result.x += change;
    result.multipliers += weight_ * (constraints_ * change.head(n) - missed);
    const double length = change.norm();
    if (length <= kConverged * result.x.norm() || (step > 1 && length > kSlowest * last)) break;
    last = length;
  }
  return result;
}

VectorXd SaddleSystem::solve(const VectorXd& right) const {
  return solve(right, VectorXd::Zero(constraints_.rows())).x;
}

// The part of a vector in the range of C: rounding elsewhere would make multipliers grow.
VectorXd SaddleSystem::in_range(const VectorXd& of_constraints, const RangeFactor& factor) const {
  constexpr int kSteps = 3;
  VectorXd combination = VectorXd::Zero(constraints_.cols());
  for (int step = 0; step < kSteps; ++step) {
    combination += factor.solve(constraints_.transpose() * (of_constraints - constraints_ * combination));
  }
  return constraints_ * combination;
}

double SaddleSystem::condition() const {
  const Eigen::Index n = matrix_.cols();
  const Eigen::Index size = n + border_.cols();
  const Eigen::Index rows = constraints_.rows();
  RangeFactor range;
  if (rows > 0) {
    Sparse shift(n, n);
    shift.setIdentity();
    range.compute(gram_ + kShift * gram_.diagonal().mean() * shift);
  }
  const auto multiply_all = [&](const VectorXd& x) -> VectorXd {
    VectorXd result(size + rows);
    result.head(size) = multiply(x.head(size));
    result.head(n) += constraints_.transpose() * x.tail(rows);
    result.tail(rows) = constraints_ * x.head(n);
    return result;
  };
  const auto solve_all = [&](const VectorXd& right) -> VectorXd {
    const Pair pair = solve(right.head(size), rows > 0 ? in_range(right.tail(rows), range) : VectorXd(0));
    VectorXd result(size + rows);
    result << pair.x, pair.multipliers;
    return result;
  };
  return condition_estimate(size + rows, multiply_all, solve_all);
}

}  // namespace orbifit

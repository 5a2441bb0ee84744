#include "moving_solve.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "orbifit/model/errors.h"
#include "orbifit/subspace/lift.h"

namespace orbifit {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kHold = 1e-10;      // of the mean of the diagonal, on coordinates
constexpr double kHoldTurns = 1e-6;  // of a turn's own stiffness, and of the largest
constexpr double kMostTurn = 0.35;   // radians in one iteration
constexpr double kConflict = 1e-9;   // of the diagonal

// A matrix on samples applied to stacked displacements.
MatrixXd applied(const Eigen::SparseMatrix<double, Eigen::RowMajor>& scalar, const MatrixXd& stacked) {
  MatrixXd result = MatrixXd::Zero(3 * scalar.rows(), stacked.cols());
  for (Eigen::Index row = 0; row < scalar.rows(); ++row) {
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator entry(scalar, row); entry; ++entry) {
      result.middleRows<3>(3 * row) += entry.value() * stacked.middleRows<3>(3 * entry.col());
    }
  }
  return result;
}

// The energy |L u - b|^2 + alpha |A u - a|_W^2 over displacements u = columns z + offset.
class SampleEnergy {
 public:
  SampleEnergy(const Corotation& corotation, const LiftWeights& points, const std::vector<double>& weights, double alpha)
      : laplacian_(corotation.laplacian), points_(points) {
    weights_.resize(3 * points.rows());
    for (Eigen::Index i = 0; i < weights_.size(); ++i) weights_[i] = std::sqrt(alpha * weights[static_cast<std::size_t>(i / 3)]);
  }

  struct Solution {
    VectorXd z;
    double energy = 0;
  };

  // The last `turns` columns are turns.
  Solution solve(const MatrixXd& columns, Eigen::Index turns, const VectorXd& offset, const VectorXd& laplace,
                 const VectorXd& targets) const {
    MatrixXd rows(3 * (laplacian_.rows() + points_.rows()), columns.cols());
    VectorXd right(rows.rows());
    rows.topRows(3 * laplacian_.rows()) = applied(laplacian_, columns);
    rows.bottomRows(weights_.size()) = weights_.asDiagonal() * applied(points_, columns);
    right.head(3 * laplacian_.rows()) = laplace - applied(laplacian_, offset);
    right.tail(weights_.size()) = weights_.cwiseProduct(targets - VectorXd(applied(points_, offset)));
    MatrixXd normal = MatrixXd::Zero(columns.cols(), columns.cols());
    normal.selfadjointView<Eigen::Lower>().rankUpdate(rows.transpose());
    const Eigen::Index rest = columns.cols() - turns;
    if (rest > 0) normal.diagonal().head(rest).array() += kHold * normal.diagonal().head(rest).mean();
    if (turns > 0) {
      const double largest = normal.diagonal().tail(turns).maxCoeff();
      normal.diagonal().tail(turns) += kHoldTurns * (normal.diagonal().tail(turns).array() + largest + 1e-300).matrix();
    }
    const Eigen::LDLT<MatrixXd, Eigen::Lower> factor(normal);
    Solution solution;
    solution.z = factor.solve(rows.transpose() * right);
    if (!solution.z.allFinite()) throw NoResultError("the handles' system could not be factorised");
    solution.energy = (rows * solution.z - right).squaredNorm();
    return solution;
  }

 private:
  Eigen::SparseMatrix<double, Eigen::RowMajor> laplacian_;
  LiftWeights points_;
  VectorXd weights_;
};

Points centres_now(const Subspace& subspace, const SubspaceState& state) {
  Points centres(subspace.regions->count(), 3);
  for (int i = 0; i < subspace.regions->count(); ++i) {
    centres.row(i) = carried_motion(subspace, state, i)(subspace.regions->centre(i)).transpose();
  }
  return centres;
}

}  // namespace

MovingSolve::MovingSolve(const Subspace& subspace, const Corotation& corotation)
    : subspace_(subspace), corotation_(corotation), regions_(subspace) {}

Deformation MovingSolve::solve(const HandleRows& handles, double alpha, const std::vector<Motion>& motions,
                               int iterations, const SubspaceState& start) const {
  const Points& rest = corotation_.rest;
  const LiftWeights spread = lift_weights(handles.rest(), rest, subspace_.sampling.radius, RunContext{});
  const SampleEnergy energy(corotation_, spread, handles.weights(), alpha);
  const VectorXd targets = handles.targets(motions);

  CarriedRegions::Turns turns = regions_.rest();
  std::vector<Eigen::Matrix3d> local(static_cast<std::size_t>(rest.rows()), Eigen::Matrix3d::Identity());
  Deformation result;
  SubspaceState& state = result.state;
  if (start.basis && start.q.size() == start.basis->columns.cols()) {
    turns = regions_.turns_of(start.basis->rotations);
    state = start;
    local = local_rotations(corotation_, rest + sample_displacements(subspace_, state), local);
  } else {
    const auto basis = std::make_shared<const CarriedBasis>(carried_basis(subspace_, regions_.rotations(turns)));
    state = {VectorXd::Zero(basis->columns.cols()), basis};
    if (start.q.size() == state.q.size()) state.q = start.q;
  }
  for (int iteration = 0; iteration < iterations; ++iteration) {
    const Points before = sample_displacements(subspace_, state);
    // Where the lift differs from mere Gaussians about the samples, the handles' targets make up for it.
    const Points lifted = vertex_displacements(subspace_, state)(handles.vertices(), Eigen::all);
    const VectorXd wanted = targets - stacked(lifted) + VectorXd(applied(spread, stacked(before)));
    Points turned_delta(rest.rows(), 3);
    for (Eigen::Index k = 0; k < rest.rows(); ++k) {
      turned_delta.row(k) =
          (local[static_cast<std::size_t>(k)] * corotation_.delta.row(k).transpose()).transpose() - corotation_.delta.row(k);
    }
    const VectorXd laplace = stacked(turned_delta);
    if (regions_.freedom() > 0) {
      const MatrixXd turning = regions_.columns(turns, rest + before, centres_now(subspace_, state));
      MatrixXd columns(3 * rest.rows(), state.q.size() + turning.cols());
      columns << MatrixXd(state.basis->columns), turning;
      const VectorXd both = energy.solve(columns, turning.cols(), state.basis->offset, laplace, wanted).z;
      VectorXd angles = both.tail(turning.cols());
      const double largest = angles.cwiseAbs().maxCoeff();
      if (largest > kMostTurn) angles *= kMostTurn / largest;
      const CarriedRegions::Turns next = regions_.turned(turns, angles);
      auto basis = std::make_shared<const CarriedBasis>(carried_basis(subspace_, regions_.rotations(next)));
      if (basis->conflict <= kConflict * subspace_.diagonal) {
        turns = next;
        state.basis = std::move(basis);
      }
    }
    const auto solution = energy.solve(MatrixXd(state.basis->columns), 0, state.basis->offset, laplace, wanted);
    state.q = solution.z;
    result.energy = solution.energy;
    const Points after = sample_displacements(subspace_, state);
    result.last_change = (after - before).rowwise().norm().maxCoeff();
    local = local_rotations(corotation_, rest + after, local);
  }
  const Points lifted = vertex_displacements(subspace_, state)(handles.vertices(), Eigen::all);
  const VectorXd missed = stacked(lifted) - targets;
  double squares = 0;
  for (Eigen::Index i = 0; i < missed.size(); ++i) {
    squares += handles.weights()[static_cast<std::size_t>(i / 3)] * missed[i] * missed[i];
  }
  result.handle_error = std::sqrt(squares / handles.total_weight());
  return result;
}

}  // namespace orbifit

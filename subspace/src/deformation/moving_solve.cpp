#include "deformation/moving_solve.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <Eigen/Cholesky>

#include "orbifit/model/errors.h"

#include "base/dense.h"
#include "basis/lift.h"
#include "basis/subspace_parts.h"

namespace orbifit {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kHoldCoordinates = 1e-10;  // of the mean of the diagonal, on coordinates
constexpr double kHoldTurns = 1e-6;         // of a turn's own stiffness, and of the largest
constexpr double kMaxTurn = 0.35;           // radians in one iteration
constexpr double kConflict = 1e-12;         // of the diagonal

// The energy |L u - b|^2 + alpha |A u - a|_W^2 over displacements u = columns z + offset.
class SampleEnergy {
 public:
  SampleEnergy(const Corotation& corotation, const LiftWeights& points, const std::vector<double>& weights,
               double alpha)
      : laplacian_(corotation.laplacian), points_(points) {
    weights_.resize(3 * points.rows());
    for (Eigen::Index i = 0; i < weights_.size(); ++i)
      weights_[i] = std::sqrt(alpha * weights[static_cast<std::size_t>(i / 3)]);
  }

  struct Solution {
    VectorXd z;
    double energy = 0;
  };

  // The last columns are turns; `turned` says how each turns the Laplace coordinates asked for.
  // `arms` how it turns the points about the samples that they follow.
  Solution solve(const MatrixXd& columns, const MatrixXd& turned, const MatrixXd& arms, const VectorXd& offset,
                 const VectorXd& laplace, const VectorXd& targets, const ContactRows& contacts) const {
    const Eigen::Index turns = turned.cols();
    MatrixXd rows(3 * (laplacian_.rows() + points_.rows()) + contacts.rows.rows(), columns.cols());
    VectorXd right(rows.rows());
    rows.topRows(3 * laplacian_.rows()) = applied(laplacian_, columns);
    rows.topRightCorner(3 * laplacian_.rows(), turns) -= turned;
    MatrixXd points = applied(points_, columns);
    points.rightCols(turns) += arms;
    rows.middleRows(3 * laplacian_.rows(), weights_.size()) = weights_.asDiagonal() * points;
    if (contacts.rows.rows() > 0) rows.bottomRows(contacts.rows.rows()) = contacts.rows;
    right.head(3 * laplacian_.rows()) = laplace - applied(laplacian_, offset);
    right.segment(3 * laplacian_.rows(), weights_.size()) =
        weights_.cwiseProduct(targets - VectorXd(applied(points_, offset)));
    right.tail(contacts.right.size()) = contacts.right;
    MatrixXd normal = MatrixXd::Zero(columns.cols(), columns.cols());
    normal.selfadjointView<Eigen::Lower>().rankUpdate(rows.transpose());
    const Eigen::Index rest = columns.cols() - turns;
    // However firm contacts are, what holds the unknowns is measured by the rest.
    VectorXd own = normal.diagonal();
    if (contacts.rows.rows() > 0) own -= contacts.rows.colwise().squaredNorm().transpose();
    if (rest > 0) normal.diagonal().head(rest).array() += kHoldCoordinates * own.head(rest).mean();
    if (turns > 0) {
      const double largest = own.tail(turns).maxCoeff();
      normal.diagonal().tail(turns) += kHoldTurns * (own.tail(turns).array() + largest + 1e-300).matrix();
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

}  // namespace

MovingSolve::MovingSolve(const Subspace& subspace, const Corotation& corotation, std::vector<Contact> contacts,
                         double contact_weight, const RunContext& context)
    : subspace_(subspace),
      corotation_(corotation),
      regions_(subspace, context),
      contacts_(std::move(contacts)),
      contact_weight_(contact_weight) {}

// As the handles turn all in all.
ConjugatedRegions::Turns MovingSolve::first_turns(const HandleRows& handles, const VectorXd& targets) const {
  constexpr double kLine = 1e-6;  // of the largest singular value: points on a line leave the turn about it open
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  const Points& rest = handles.rest();
  Points there = rest;
  for (Eigen::Index i = 0; i < rest.rows(); ++i) there.row(i) += targets.segment<3>(3 * i).transpose();
  const Eigen::RowVector3d from = rest.colwise().mean();
  const Eigen::RowVector3d to = there.colwise().mean();
  for (Eigen::Index i = 0; i < rest.rows(); ++i) {
    sum += handles.weights()[static_cast<std::size_t>(i)] * (there.row(i) - to).transpose() * (rest.row(i) - from);
  }
  const Eigen::Vector3d values = Eigen::JacobiSVD<Eigen::Matrix3d>(sum).singularValues();
  if (!(values[1] > kLine * values[0])) return regions_.rest();
  ConjugatedRegions::Turns turns = regions_.as_one(blended_rotation(sum));
  const bool agree = keeps_freedom(subspace_, regions_.rotations(turns), kConflict * subspace_->diagonal);
  return agree ? turns : regions_.rest();
}

Deformation MovingSolve::solve(const HandleRows& handles, double alpha, const std::vector<Motion>& motions,
                               int iterations, const SubspaceState& start, const RunContext& context) const {
  const Points& rest = corotation_.rest;
  const LiftWeights spread = lift_weights(handles.rest(), rest, subspace_->sampling.radius, RunContext{});
  const SampleEnergy energy(corotation_, spread, handles.weights(), alpha);
  const VectorXd targets = handles.targets(motions);

  ConjugatedRegions::Turns turns = regions_.rest();
  std::vector<Eigen::Matrix3d> local(static_cast<std::size_t>(rest.rows()), Eigen::Matrix3d::Identity());
  const auto turned_coordinates = [&](const std::vector<Eigen::Matrix3d>& by) {
    Points turned(rest.rows(), 3);
    for (Eigen::Index k = 0; k < rest.rows(); ++k) {
      turned.row(k) = (by[static_cast<std::size_t>(k)] * corotation_.delta.row(k).transpose()).transpose();
    }
    return turned;
  };
  Deformation result;
  SubspaceState& state = result.state;
  const bool fresh = !(start.basis && start.q.size() == start.basis->columns.cols());
  if (!fresh) {
    turns = regions_.turns_of(start.basis->rotations);
    state = start;
    local = local_rotations(corotation_, rest + sample_displacements(subspace_, state), local);
  } else {
    turns = first_turns(handles, targets);
    const auto basis = std::make_shared<const ConjugatedBasis>(conjugated_basis(subspace_, regions_.rotations(turns)));
    state = {VectorXd::Zero(basis->columns.cols()), basis};
    if (start.q.size() == state.q.size()) state.q = start.q;
    for (std::size_t k = 0; k < local.size(); ++k) {
      const int region = innermost_region(*subspace_->regions, subspace_->sampling.sets[k]);
      if (region >= 0) local[k] = basis->rotations[static_cast<std::size_t>(region)];
    }
  }
  const auto contact_rows = [&](const SmallTurns* small) {
    if (contacts_.empty()) return ContactRows{};
    return contact_rows_at(contacts_, contact_weight_, subspace_, state, vertex_displacements(subspace_, state), local,
                           small);
  };
  // The best coordinates for groups that stand as they do, and the local rotations to them.
  const auto follow = [&](const Points& before, const VectorXd& wanted, const Points& turned_delta) {
    context.check();
    const auto solution =
        energy.solve(MatrixXd(state.basis->columns), MatrixXd(3 * rest.rows(), 0), MatrixXd(wanted.size(), 0),
                     state.basis->offset, stacked(turned_delta - corotation_.delta), wanted, contact_rows(nullptr));
    state.q = solution.z;
    result.energy = solution.energy;
    const Points after = sample_displacements(subspace_, state);
    result.last_change = (after - before).rowwise().norm().maxCoeff();
    local = local_rotations(corotation_, rest + after, local);
  };
  if (fresh) follow(sample_displacements(subspace_, state), targets, turned_coordinates(local));
  for (int iteration = 0; iteration < iterations; ++iteration) {
    context.progress("iterations", static_cast<double>(iteration) / iterations);
    const Points before = sample_displacements(subspace_, state);
    // Where the lift differs from mere Gaussians about the samples, the handles' targets make up for it.
    const Points lifted = vertex_displacements(subspace_, state)(handles.vertices(), Eigen::all);
    const VectorXd wanted = targets - stacked(lifted) + VectorXd(applied(spread, stacked(before)));
    Points turned_delta = turned_coordinates(local);
    if (regions_.freedom() > 0) {
      const MatrixXd turning = regions_.columns(turns, rest + before, region_centres(subspace_, state));
      MatrixXd columns(3 * rest.rows(), state.q.size() + turning.cols());
      columns << MatrixXd(state.basis->columns), turning;
      // What a group turns takes its Laplace coordinates along, so that turning as such costs nothing.
      const MatrixXd along = regions_.columns(turns, turned_delta, Points::Zero(subspace_->regions->count(), 3));
      const VectorXd laplace = stacked(turned_delta - corotation_.delta);
      const SmallTurns small{regions_, turns, turning};
      const VectorXd both = energy
                                .solve(columns, along, regions_.arms(turns, spread, handles.rest() - spread * rest),
                                       state.basis->offset, laplace, wanted, contact_rows(&small))
                                .z;
      VectorXd angles = both.tail(turning.cols());
      const double largest = angles.cwiseAbs().maxCoeff();
      context.check();
      if (largest > kMaxTurn) angles *= kMaxTurn / largest;
      const ConjugatedRegions::Turns next = regions_.turned(turns, angles);
      auto basis = std::make_shared<const ConjugatedBasis>(conjugated_basis(subspace_, regions_.rotations(next)));
      if (basis->conflict <= kConflict * subspace_->diagonal) {
        for (Eigen::Index k = 0; k < rest.rows(); ++k) {
          const auto sample = static_cast<std::size_t>(k);
          const int region = innermost_region(*subspace_->regions, subspace_->sampling.sets[sample]);
          if (region < 0) continue;
          const auto r = static_cast<std::size_t>(region);
          local[sample] = basis->rotations[r] * state.basis->rotations[r].transpose() * local[sample];
        }
        turned_delta = turned_coordinates(local);
        turns = next;
        state.basis = std::move(basis);
      }
    }
    follow(before, wanted, turned_delta);
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

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

using SparseRows = Eigen::SparseMatrix<double, Eigen::RowMajor>;

// A (x) I_3.
SparseRows thrice(const SparseRows& scalar) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(3 * static_cast<std::size_t>(scalar.nonZeros()));
  for (Eigen::Index row = 0; row < scalar.rows(); ++row) {
    for (SparseRows::InnerIterator entry(scalar, row); entry; ++entry) {
      for (Eigen::Index c = 0; c < 3; ++c) entries.emplace_back(3 * row + c, 3 * entry.col() + c, entry.value());
    }
  }
  SparseRows result(3 * scalar.rows(), 3 * scalar.cols());
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

// Adds the lower half of rows^T rows. A row touches few coordinates: those of the samples near its own.
void add_lower_gram(const SparseRows& rows, Eigen::Ref<MatrixXd> gram) {
  for (Eigen::Index row = 0; row < rows.rows(); ++row) {
    for (SparseRows::InnerIterator a(rows, row); a; ++a) {
      for (SparseRows::InnerIterator b = a; b; ++b) gram(b.col(), a.col()) += a.value() * b.value();
    }
  }
}

// How displacements start to change as the groups turn: of the samples, of the Laplace coordinates asked for, and of
// the handles' points about the samples that they follow.
struct Turning {
  MatrixXd samples, along, arms;
};

// The energy |L u - b|^2 + alpha |A u - a|_W^2 over displacements u = columns z + offset.
class SampleEnergy {
 public:
  SampleEnergy(const Corotation& corotation, const LiftWeights& points, const std::vector<double>& weights,
               double alpha)
      : laplacian_(thrice(corotation.laplacian)), points_(thrice(points)) {
    weights_.resize(points_.rows());
    for (Eigen::Index i = 0; i < weights_.size(); ++i)
      weights_[i] = std::sqrt(alpha * weights[static_cast<std::size_t>(i / 3)]);
    points_ = weights_.asDiagonal() * points_;
  }

  struct Solution {
    VectorXd z;
    double energy = 0;
  };

  // The last unknowns are turns.
  Solution solve(const SparseRows& columns, const Turning& turning, const VectorXd& offset, const VectorXd& laplace,
                 const VectorXd& targets, const ContactRows& contacts) const {
    const Eigen::Index rest = columns.cols();
    const Eigen::Index turns = turning.samples.cols();
    const Part parts[] = {
        {laplacian_ * columns, laplacian_ * turning.samples - turning.along, laplace - laplacian_ * offset},
        {points_ * columns, points_ * turning.samples + weights_.asDiagonal() * turning.arms,
         weights_.cwiseProduct(targets) - points_ * offset},
        {contacts.rows.leftCols(rest).sparseView(), contacts.rows.rightCols(turns), contacts.right}};
    MatrixXd normal = MatrixXd::Zero(rest + turns, rest + turns);
    VectorXd side = VectorXd::Zero(rest + turns);
    VectorXd own;  // however firm contacts are, what holds the unknowns is measured by the rest
    for (const Part& part : parts) {
      if (&part == &parts[2]) own = normal.diagonal();
      add_lower_gram(part.rows, normal.topLeftCorner(rest, rest));
      normal.bottomLeftCorner(turns, rest) += part.turns.transpose() * part.rows;
      normal.bottomRightCorner(turns, turns) += part.turns.transpose() * part.turns;
      side.head(rest) += part.rows.transpose() * part.right;
      side.tail(turns) += part.turns.transpose() * part.right;
    }
    if (rest > 0) normal.diagonal().head(rest).array() += kHoldCoordinates * own.head(rest).mean();
    if (turns > 0) {
      const double largest = own.tail(turns).maxCoeff();
      normal.diagonal().tail(turns) += kHoldTurns * (own.tail(turns).array() + largest + 1e-300).matrix();
    }
    const Eigen::LDLT<MatrixXd, Eigen::Lower> factor(normal);
    Solution solution;
    solution.z = factor.solve(side);
    if (!solution.z.allFinite()) throw NoResultError("the handles' system could not be factorised");
    for (const Part& part : parts) {
      solution.energy +=
          (part.rows * solution.z.head(rest) + part.turns * solution.z.tail(turns) - part.right).squaredNorm();
    }
    return solution;
  }

 private:
  struct Part {
    SparseRows rows;
    MatrixXd turns;
    VectorXd right;
  };

  SparseRows laplacian_, points_;  // by coordinates, the points weighted
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
    if (contacts_.empty()) {
      return ContactRows{MatrixXd(0, state.q.size() + (small != nullptr ? small->columns.cols() : 0)), VectorXd(0)};
    }
    return contact_rows_at(contacts_, contact_weight_, subspace_, state, vertex_displacements(subspace_, state), local,
                           small);
  };
  const Turning still{MatrixXd(3 * rest.rows(), 0), MatrixXd(3 * rest.rows(), 0), MatrixXd(targets.size(), 0)};
  // The best coordinates for groups that stand as they do, and the local rotations to them.
  const auto follow = [&](const Points& before, const VectorXd& wanted, const Points& turned_delta) {
    context.check();
    const auto solution = energy.solve(state.basis->columns, still, state.basis->offset,
                                       stacked(turned_delta - corotation_.delta), wanted, contact_rows(nullptr));
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
      // What a group turns takes its Laplace coordinates along, so that turning as such costs nothing.
      const Turning all{turning, regions_.columns(turns, turned_delta, Points::Zero(subspace_->regions->count(), 3)),
                        regions_.arms(turns, spread, handles.rest() - spread * rest)};
      const VectorXd laplace = stacked(turned_delta - corotation_.delta);
      const SmallTurns small{regions_, turns, turning};
      const VectorXd both =
          energy.solve(state.basis->columns, all, state.basis->offset, laplace, wanted, contact_rows(&small)).z;
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

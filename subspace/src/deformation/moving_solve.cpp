#include "deformation/moving_solve.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <utility>

#include <Eigen/SVD>

#include "basis/lift.h"
#include "basis/subspace_parts.h"
#include "deformation/sample_energy.h"

namespace orbifit {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kMaxTurn = 0.35;    // radians in one iteration
constexpr double kConflict = 1e-12;  // of the diagonal

}  // namespace

// One solve on its way: how the groups stand, the state with them, and the samples' local rotations.
class MovingSolve::Run {
 public:
  Run(const MovingSolve& of, const HandleRows& handles, double alpha, const std::vector<Motion>& motions,
      const RunContext& context);

  // Goes on from `start` where that has a basis of its own, or has the groups turn as the handles do all in all.
  void begin(const SubspaceState& start);
  void iterate();
  Deformation finish();

 private:
  void turn_groups(const Points& before, const VectorXd& wanted);
  void accept(const ConjugatedRegions::Turns& next, std::shared_ptr<const ConjugatedBasis> basis);
  void follow(const Points& before, const VectorXd& wanted);
  Points turned_coordinates() const;
  ContactRows contact_rows(const SmallTurns* small) const;
  Points lifted() const;
  int region_of(std::size_t sample) const;

  const MovingSolve& of_;
  const Subspace& subspace_;
  const Corotation& corotation_;
  const ConjugatedRegions& regions_;
  const HandleRows& handles_;
  const RunContext& context_;
  LiftWeights spread_;  // handles' points by samples
  SampleEnergy energy_;
  VectorXd targets_;
  Turning still_;  // no way of turning
  ConjugatedRegions::Turns turns_;
  std::vector<Eigen::Matrix3d> local_;  // by sample
  Deformation result_;
  SubspaceState& state_ = result_.state;
};

MovingSolve::Run::Run(const MovingSolve& of, const HandleRows& handles, double alpha,
                      const std::vector<Motion>& motions, const RunContext& context)
    : of_(of),
      subspace_(of.subspace_),
      corotation_(of.corotation_),
      regions_(of.regions_),
      handles_(handles),
      context_(context),
      spread_(lift_weights(handles.rest(), corotation_.rest, subspace_->sampling.radius, RunContext{})),
      energy_(corotation_, spread_, handles.weights(), alpha),
      targets_(handles.targets(motions)),
      turns_(regions_.rest()),
      local_(static_cast<std::size_t>(corotation_.rest.rows()), Eigen::Matrix3d::Identity()) {
  const Eigen::Index coordinates = corotation_.rest.size();
  still_ = {MatrixXd(coordinates, 0), MatrixXd(coordinates, 0), MatrixXd(targets_.size(), 0)};
}

void MovingSolve::Run::begin(const SubspaceState& start) {
  if (start.basis && start.q.size() == start.basis->columns.cols()) {
    turns_ = regions_.turns_of(start.basis->rotations);
    state_ = start;
    local_ = local_rotations(corotation_, corotation_.rest + sample_displacements(subspace_, state_), local_);
    return;
  }
  turns_ = of_.first_turns(handles_, targets_);
  const auto basis = std::make_shared<const ConjugatedBasis>(conjugated_basis(subspace_, regions_.rotations(turns_)));
  state_ = {VectorXd::Zero(basis->columns.cols()), basis};
  if (start.q.size() == state_.q.size()) state_.q = start.q;
  for (std::size_t k = 0; k < local_.size(); ++k) {
    const int region = region_of(k);
    if (region >= 0) local_[k] = basis->rotations[static_cast<std::size_t>(region)];
  }
  follow(sample_displacements(subspace_, state_), targets_);
}

void MovingSolve::Run::iterate() {
  const Points before = sample_displacements(subspace_, state_);
  // Where the lift differs from mere Gaussians about the samples, the handles' targets make up for it.
  const VectorXd wanted = targets_ - stacked(lifted()) + VectorXd(applied(spread_, stacked(before)));
  if (regions_.freedom() > 0) turn_groups(before, wanted);
  follow(before, wanted);
}

// Coordinates and groups together, to first order; of that the groups' turns are kept, where they contradict nothing.
void MovingSolve::Run::turn_groups(const Points& before, const VectorXd& wanted) {
  const Points turned_delta = turned_coordinates();
  const MatrixXd turning = regions_.columns(turns_, corotation_.rest + before, region_centres(subspace_, state_));
  // What a group turns takes its Laplace coordinates along, so that turning as such costs nothing.
  const Turning all{turning, regions_.columns(turns_, turned_delta, Points::Zero(subspace_->regions->count(), 3)),
                    regions_.arms(turns_, spread_, handles_.rest() - spread_ * corotation_.rest)};
  const SmallTurns small{regions_, turns_, turning};
  const VectorXd both = energy_
                            .solve(state_.basis->columns, all, state_.basis->offset,
                                   stacked(turned_delta - corotation_.delta), wanted, contact_rows(&small))
                            .z;
  VectorXd angles = both.tail(turning.cols());
  const double largest = angles.cwiseAbs().maxCoeff();
  context_.check();
  if (largest > kMaxTurn) angles *= kMaxTurn / largest;
  const ConjugatedRegions::Turns next = regions_.turned(turns_, angles);
  auto basis = std::make_shared<const ConjugatedBasis>(conjugated_basis(subspace_, regions_.rotations(next)));
  if (basis->conflict <= kConflict * subspace_->diagonal) accept(next, std::move(basis));
}

void MovingSolve::Run::accept(const ConjugatedRegions::Turns& next, std::shared_ptr<const ConjugatedBasis> basis) {
  for (std::size_t k = 0; k < local_.size(); ++k) {
    const int region = region_of(k);
    if (region < 0) continue;
    const auto r = static_cast<std::size_t>(region);
    local_[k] = basis->rotations[r] * state_.basis->rotations[r].transpose() * local_[k];
  }
  turns_ = next;
  state_.basis = std::move(basis);
}

// The best coordinates for groups that stand as they do, and the local rotations to them.
void MovingSolve::Run::follow(const Points& before, const VectorXd& wanted) {
  context_.check();
  const auto solution = energy_.solve(state_.basis->columns, still_, state_.basis->offset,
                                      stacked(turned_coordinates() - corotation_.delta), wanted, contact_rows(nullptr));
  state_.q = solution.z;
  result_.energy = solution.energy;
  const Points after = sample_displacements(subspace_, state_);
  result_.last_change = (after - before).rowwise().norm().maxCoeff();
  local_ = local_rotations(corotation_, corotation_.rest + after, local_);
}

Deformation MovingSolve::Run::finish() {
  const VectorXd missed = stacked(lifted()) - targets_;
  double squares = 0;
  for (Eigen::Index i = 0; i < missed.size(); ++i) {
    squares += handles_.weights()[static_cast<std::size_t>(i / 3)] * missed[i] * missed[i];
  }
  result_.handle_error = std::sqrt(squares / handles_.total_weight());
  return std::move(result_);
}

Points MovingSolve::Run::turned_coordinates() const {
  Points turned(corotation_.delta.rows(), 3);
  for (Eigen::Index k = 0; k < turned.rows(); ++k) {
    turned.row(k) = (local_[static_cast<std::size_t>(k)] * corotation_.delta.row(k).transpose()).transpose();
  }
  return turned;
}

ContactRows MovingSolve::Run::contact_rows(const SmallTurns* small) const {
  if (of_.contacts_.empty()) {
    return {MatrixXd(0, state_.q.size() + (small != nullptr ? small->columns.cols() : 0)), VectorXd(0)};
  }
  return contact_rows_at(of_.contacts_, of_.contact_weight_, subspace_, state_, vertex_displacements(subspace_, state_),
                         local_, small);
}

// Displacements of the handles' points.
Points MovingSolve::Run::lifted() const {
  return vertex_displacements(subspace_, state_)(handles_.vertices(), Eigen::all);
}

int MovingSolve::Run::region_of(std::size_t sample) const {
  return innermost_region(*subspace_->regions, subspace_->sampling.sets[sample]);
}

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
  Run run(*this, handles, alpha, motions, context);
  run.begin(start);
  for (int iteration = 0; iteration < iterations; ++iteration) {
    context.progress("iterations", static_cast<double>(iteration) / iterations);
    run.iterate();
  }
  return run.finish();
}

}  // namespace orbifit

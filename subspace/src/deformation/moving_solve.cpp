#include "deformation/moving_solve.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <utility>

#include <Eigen/SVD>

#include "basis/subspace_parts.h"
#include "deformation/sample_energy.h"

namespace orbifit {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kMaxTurn = 0.35;         // radians in one iteration
constexpr double kLeastShare = 1.0 / 16;  // of a turn that is tried: a degree at most
constexpr double kRounded = 1e-9;         // of an energy: what holds the coordinates, and rounding, may add as much
constexpr double kConflict = 1e-12;       // of the diagonal

}  // namespace

// How the groups stand, and what follows from it: the basis, the samples' local rotations, the handles' points.
struct MovingSolve::Stand {
  ConjugatedRegions::Turns turns;
  std::shared_ptr<const ConjugatedBasis> basis;
  std::vector<Eigen::Matrix3d> local;  // by sample
  HandlePoints points;
};

// The best coordinates for groups that stand so, and the local rotations to them.
struct MovingSolve::Solved {
  Stand stand;
  VectorXd q;
  double energy = 0;
};

// One solve on its way.
class MovingSolve::Run {
 public:
  Run(const MovingSolve& of, const HandleRows& handles, double alpha, const std::vector<Motion>& motions,
      const RunContext& context);

  // Goes on from `start` where that has a basis of its own, or has the groups turn as the handles do all in all.
  void begin(const SubspaceState& start);
  void iterate();
  Deformation finish();

 private:
  VectorXd turns_wanted(const SampleEnergy::Terms& now, const Points& before) const;
  Solved turn_groups(const Points& before);
  Solved solved(Stand stand) const;
  void accept(Solved next, const Points& before);
  Stand turned(const ConjugatedRegions::Turns& turns, std::shared_ptr<const ConjugatedBasis> basis) const;
  HandlePoints points_of(const std::shared_ptr<const ConjugatedBasis>& basis) const;
  SampleEnergy::Terms terms(const Stand& stand) const;
  Points turned_coordinates(const Stand& stand) const;
  ContactRows contact_rows(const Stand& stand, const SmallTurns* small) const;
  Points lifted(const SubspaceState& state) const;
  int region_of(std::size_t sample) const;

  const MovingSolve& of_;
  const Subspace& subspace_;
  const Corotation& corotation_;
  const ConjugatedRegions& regions_;
  const HandleRows& handles_;
  const RunContext& context_;
  VectorXd targets_;
  SampleEnergy energy_;
  Turning still_;     // no way of turning
  double share_ = 1;  // of the turns wanted, that the next iteration tries first
  Stand stand_;
  Deformation result_;
  VectorXd& q_ = result_.state.q;
};

MovingSolve::Run::Run(const MovingSolve& of, const HandleRows& handles, double alpha,
                      const std::vector<Motion>& motions, const RunContext& context)
    : of_(of),
      subspace_(of.subspace_),
      corotation_(of.corotation_),
      regions_(of.regions_),
      handles_(handles),
      context_(context),
      targets_(handles.targets(motions)),
      energy_(corotation_, handles.weights(), alpha, BoundedEdit(subspace_->diagonal, targets_)) {
  const Eigen::Index coordinates = corotation_.rest.size();
  still_ = {MatrixXd(coordinates, 0), MatrixXd(coordinates, 0), MatrixXd(targets_.size(), 0)};
}

void MovingSolve::Run::begin(const SubspaceState& start) {
  stand_.local.assign(static_cast<std::size_t>(corotation_.rest.rows()), Eigen::Matrix3d::Identity());
  if (start.basis && start.q.size() == start.basis->columns.cols()) {
    q_ = start.q;
    const Points there = corotation_.rest + sample_displacements(subspace_, start);
    stand_ = {regions_.turns_of(start.basis->rotations), start.basis, local_rotations(corotation_, there, stand_.local),
              points_of(start.basis)};
    return;
  }
  const ConjugatedRegions::Turns turns = of_.first_turns(handles_, targets_);
  const auto basis = std::make_shared<const ConjugatedBasis>(conjugated_basis(subspace_, regions_.rotations(turns)));
  q_ = start.q.size() == basis->columns.cols() ? start.q : VectorXd(VectorXd::Zero(basis->columns.cols()));
  stand_ = {turns, basis, std::move(stand_.local), points_of(basis)};
  for (std::size_t k = 0; k < stand_.local.size(); ++k) {
    const int region = region_of(k);
    if (region >= 0) stand_.local[k] = basis->rotations[static_cast<std::size_t>(region)];
  }
  accept(solved(stand_), sample_displacements(subspace_, SubspaceState{q_, basis}));
}

void MovingSolve::Run::iterate() {
  context_.check();
  const Points before = sample_displacements(subspace_, SubspaceState{q_, stand_.basis});
  accept(regions_.freedom() > 0 ? turn_groups(before) : solved(stand_), before);
}

// The best coordinates for groups that turn as they should to first order, or less far where the energy grows, or not
// at all where they contradict one another.
MovingSolve::Solved MovingSolve::Run::turn_groups(const Points& before) {
  const SampleEnergy::Terms now = terms(stand_);
  const VectorXd angles = turns_wanted(now, before);
  const double energy = energy_.value(now, q_);
  for (; share_ >= kLeastShare; share_ /= 2) {
    context_.check();
    const ConjugatedRegions::Turns turns = regions_.turned(stand_.turns, share_ * angles);
    auto basis = std::make_shared<const ConjugatedBasis>(conjugated_basis(subspace_, regions_.rotations(turns)));
    if (!(basis->conflict <= kConflict * subspace_->diagonal)) return solved(stand_);
    Solved next = solved(turned(turns, std::move(basis)));
    if (!(energy_.value(terms(next.stand), next.q) <= energy * (1 + kRounded))) continue;
    share_ = std::min(1.0, 2 * share_);
    return next;
  }
  share_ = kLeastShare;  // the next iteration tries once
  return solved(stand_);
}

MovingSolve::Solved MovingSolve::Run::solved(Stand stand) const {
  SampleEnergy::Solution solution = energy_.solve(terms(stand), still_);
  const Points there = corotation_.rest + sample_displacements(subspace_, SubspaceState{solution.z, stand.basis});
  stand.local = local_rotations(corotation_, there, stand.local);
  return {std::move(stand), std::move(solution.z), solution.energy};
}

// Coordinates and groups together, to first order: the groups' turns of that, radians.
VectorXd MovingSolve::Run::turns_wanted(const SampleEnergy::Terms& now, const Points& before) const {
  const SubspaceState state{q_, stand_.basis};
  const Points turned_delta = turned_coordinates(stand_);
  const Points centres = region_centres(subspace_, state);
  const MatrixXd turning = regions_.columns(stand_.turns, corotation_.rest + before, centres);
  // What a group turns takes its Laplace coordinates along, so that turning as such costs nothing.
  const Turning all{
      turning, regions_.columns(stand_.turns, turned_delta, Points::Zero(subspace_->regions->count(), 3)),
      regions_.vertex_columns(stand_.turns, handles_.vertices(), handles_.rest() + lifted(state), centres)};
  const SmallTurns small{regions_, stand_.turns, turning};
  SampleEnergy::Terms both = now;
  both.contacts = contact_rows(stand_, &small);
  VectorXd angles = energy_.solve(both, all).z.tail(turning.cols());
  const double largest = angles.cwiseAbs().maxCoeff();
  if (largest > kMaxTurn) angles *= kMaxTurn / largest;
  return angles;
}

MovingSolve::Stand MovingSolve::Run::turned(const ConjugatedRegions::Turns& turns,
                                            std::shared_ptr<const ConjugatedBasis> basis) const {
  Stand next{turns, std::move(basis), stand_.local, {}};
  next.points = points_of(next.basis);
  for (std::size_t k = 0; k < next.local.size(); ++k) {
    const int region = region_of(k);
    if (region < 0) continue;
    const auto r = static_cast<std::size_t>(region);
    next.local[k] = next.basis->rotations[r] * stand_.basis->rotations[r].transpose() * stand_.local[k];
  }
  return next;
}

void MovingSolve::Run::accept(Solved next, const Points& before) {
  stand_ = std::move(next.stand);
  q_ = std::move(next.q);
  result_.energy = next.energy;
  const Points after = sample_displacements(subspace_, SubspaceState{q_, stand_.basis});
  result_.last_change = (after - before).rowwise().norm().maxCoeff();
}

Deformation MovingSolve::Run::finish() {
  result_.state.basis = stand_.basis;
  const VectorXd missed = stacked(lifted(result_.state)) - targets_;
  double squares = 0;
  for (Eigen::Index i = 0; i < missed.size(); ++i) {
    squares += handles_.weights()[static_cast<std::size_t>(i / 3)] * missed[i] * missed[i];
  }
  result_.handle_error = std::sqrt(squares / handles_.total_weight());
  return std::move(result_);
}

SampleEnergy::Terms MovingSolve::Run::terms(const Stand& stand) const {
  return {*stand.basis, stand.points, stacked(turned_coordinates(stand) - corotation_.delta), targets_,
          contact_rows(stand, nullptr)};
}

Points MovingSolve::Run::turned_coordinates(const Stand& stand) const {
  Points turned(corotation_.delta.rows(), 3);
  for (Eigen::Index k = 0; k < turned.rows(); ++k) {
    turned.row(k) = (stand.local[static_cast<std::size_t>(k)] * corotation_.delta.row(k).transpose()).transpose();
  }
  return turned;
}

ContactRows MovingSolve::Run::contact_rows(const Stand& stand, const SmallTurns* small) const {
  if (of_.contacts_.empty()) {
    return {MatrixXd(0, q_.size() + (small != nullptr ? small->columns.cols() : 0)), VectorXd(0)};
  }
  const SubspaceState state{q_, stand.basis};
  return contact_rows_at(of_.contacts_, of_.contact_weight_, subspace_, state, vertex_displacements(subspace_, state),
                         stand.local, small);
}

// How the handles' points follow the coordinates: by the lift itself, whatever it makes of the samples.
HandlePoints MovingSolve::Run::points_of(const std::shared_ptr<const ConjugatedBasis>& basis) const {
  const Eigen::Index freedom = basis->columns.cols();
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t i = 0; i < handles_.vertices().size(); ++i) {
    Eigen::Matrix3Xd rows = Eigen::Matrix3Xd::Zero(3, freedom);
    add_vertex_rows(subspace_, *basis, handles_.vertices()[i], rows);
    for (Eigen::Index j = 0; j < freedom; ++j) {
      for (Eigen::Index c = 0; c < 3; ++c) {
        if (rows(c, j) != 0) entries.emplace_back(3 * static_cast<Eigen::Index>(i) + c, j, rows(c, j));
      }
    }
  }
  HandlePoints points;
  points.rows.resize(3 * handles_.rest().rows(), freedom);
  points.rows.setFromTriplets(entries.begin(), entries.end());
  points.offset = stacked(lifted({VectorXd::Zero(freedom), basis}));
  return points;
}

// Displacements of the handles' points.
Points MovingSolve::Run::lifted(const SubspaceState& state) const {
  return vertex_displacements(subspace_, state)(handles_.vertices(), Eigen::all);
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

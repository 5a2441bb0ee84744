#include "solver/moving_system.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "orbifit/model/errors.h"

#include "base/dense.h"
#include "basis/subspace_parts.h"
#include "deformation/corotation.h"
#include "solver/condition.h"
#include "solver/rigid_modes.h"
#include "solver/vertex_rows.h"

namespace orbifit {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kMaxTurn = 0.2;     // radians in one iteration
constexpr double kHoldTurns = 1e-4;  // of a turn, relative to moving the samples as far one by one
constexpr double kConflict = 1e-9;   // of the diagonal
constexpr Index kEntries = 9;        // of a turn

// Adds to the lower half the rows from `first` on: what couples them with the columns before, and with themselves.
void add_lower_rows(Index first, const MatrixXd& before, const MatrixXd& own, Eigen::SparseMatrix<double>& lower) {
  std::vector<Eigen::Triplet<double>> entries;
  for (Index i = 0; i < own.rows(); ++i) {
    for (Index j = 0; j < before.cols(); ++j) {
      if (before(i, j) != 0) entries.emplace_back(first + i, j, before(i, j));
    }
    for (Index j = 0; j <= i; ++j) entries.emplace_back(first + i, first + j, own(i, j));
  }
  Eigen::SparseMatrix<double> rows(lower.rows(), lower.cols());
  rows.setFromTriplets(entries.begin(), entries.end());
  lower += rows;
}

}  // namespace

MovingSystem::MovingSystem(const Subspace& subspace, const Mesh& mesh, double stretch, std::vector<Contact> contacts,
                           const RunContext& context)
    : DeformationSystem(CorotatedEnergy(subspace->sampling.points, subspace->sampling.radius, stretch)),
      subspace_(subspace),
      mesh_(mesh),
      contacts_(std::move(contacts)),
      regions_(subspace, context),
      stiffness_(energy_.matrix()),
      rigid_(rigid_modes(subspace->sampling.points)),
      step_{bounding_box_centre(mesh.vertices), diagonal(mesh.vertices)} {}

VectorXd MovingSystem::at_rest(const VectorXd& coordinates) const {
  const ConjugatedRegions::Turns turns = regions_.rest();
  VectorXd q(coordinates.size() + kEntries * static_cast<Index>(turns.size()));
  q.head(coordinates.size()) = coordinates;
  for (std::size_t f = 0; f < turns.size(); ++f) {
    Eigen::Map<Eigen::Matrix3d>(q.data() + coordinates.size() + kEntries * static_cast<Index>(f)) = turns[f];
  }
  return q;
}

ConjugatedRegions::Turns MovingSystem::turns_of(const VectorXd& q) const {
  const Index dof = subspace_.degrees_of_freedom();
  ConjugatedRegions::Turns turns = regions_.rest();
  for (std::size_t f = 0; f < turns.size(); ++f) {
    turns[f] = Eigen::Map<const Eigen::Matrix3d>(q.data() + dof + kEntries * static_cast<Index>(f));
  }
  return turns;
}

std::shared_ptr<const ConjugatedBasis> MovingSystem::basis_at(const ConjugatedRegions::Turns& turns) const {
  constexpr std::size_t kKept = 2;  // where a step begins and where it ends: one of them is gone back to
  const auto at = std::ranges::find(known_, turns, &KnownBasis::turns);
  if (at != known_.end()) {
    std::rotate(at, at + 1, known_.end());
  } else {
    if (known_.size() == kKept) known_.erase(known_.begin());
    known_.push_back(
        {turns, std::make_shared<const ConjugatedBasis>(conjugated_basis(subspace_, regions_.rotations(turns)))});
  }
  return known_.back().basis;
}

SubspaceState MovingSystem::state_of(const VectorXd& q) const {
  return {q.head(subspace_.degrees_of_freedom()), basis_at(turns_of(q))};
}

Points MovingSystem::samples_at(const VectorXd& q) const {
  return sample_displacements(subspace_, state_of(q));
}

Points MovingSystem::vertices_at(const VectorXd& q, const RunContext& context) const {
  return vertex_displacements(subspace_, state_of(q), context);
}

VectorXd MovingSystem::turned(const VectorXd& q, const VectorXd& angles, const Points& displacements) const {
  const Index dof = subspace_.degrees_of_freedom();
  const ConjugatedRegions::Turns next = regions_.turned(turns_of(q), angles);
  const std::shared_ptr<const ConjugatedBasis> basis = basis_at(next);
  if (basis->conflict > kConflict * subspace_->diagonal || basis->columns.cols() != dof) return {};
  VectorXd result = at_rest(q.head(dof));
  for (std::size_t f = 0; f < next.size(); ++f) {
    Eigen::Map<Eigen::Matrix3d>(result.data() + dof + kEntries * static_cast<Index>(f)) = next[f];
  }
  constexpr double kRidge = 1e-9;  // coordinates that move no sample stay
  MatrixXd gram = basis->columns.transpose() * basis->columns;
  const double ridge = kRidge * gram.diagonal().mean();
  gram.diagonal().array() += ridge;
  const VectorXd side = basis->columns.transpose() * (stacked(displacements) - basis->offset) + ridge * q.head(dof);
  result.head(dof) = solve_semidefinite(gram, side);
  return result;
}

double MovingSystem::contact_energy(const VectorXd& q) const {
  if (contacts_.empty()) return 0;
  const SubspaceState state = state_of(q);
  const ContactRows contacts =
      contact_rows_at(contacts_, kContactWeight, subspace_, state, vertex_displacements(subspace_, state), rotations());
  return (contacts.rows * state.q - contacts.right).squaredNorm();
}

MovingSystem::Linearised MovingSystem::linearised(const VectorXd& q, const RunContext& context) const {
  Linearised at;
  at.now = state_of(q);
  at.turns = turns_of(q);
  at.moved = sample_displacements(subspace_, at.now);
  at.deformed.vertices = mesh_.vertices + vertex_displacements(subspace_, at.now, context);
  at.deformed.faces = mesh_.faces;
  at.turn_columns =
      regions_.columns(at.turns, subspace_->sampling.points + at.moved, region_centres(subspace_, at.now));
  return at;
}

VertexRows MovingSystem::rows_at(const Linearised& at, const std::vector<int>& touched,
                                 const RunContext& context) const {
  const Points now = at.deformed.vertices(touched, Eigen::all);
  const MatrixXd turning = regions_.vertex_columns(at.turns, touched, now, region_centres(subspace_, at.now));
  VertexRows rows(subspace_, *at.now.basis);
  rows.prepare(touched, context);
  const int dof = subspace_.degrees_of_freedom();
  for (std::size_t i = 0; i < touched.size(); ++i) {
    rows.extend(touched[i], dof, turning.middleRows<3>(3 * static_cast<Index>(i)));
  }
  return rows;
}

void MovingSystem::add_regularity(const Linearised& at, double stiffness, NormalEquations& normal) const {
  const Index dof = subspace_.degrees_of_freedom();
  const Index ways = regions_.freedom();
  const Eigen::SparseMatrix<double>& columns = at.now.basis->columns;
  const VectorXd pull = stiffness * stacked(energy_.pull() - Points(stiffness_ * at.moved));
  const MatrixXd bent = stiffness * applied(LiftWeights(stiffness_), at.turn_columns);
  Eigen::SparseMatrix<double> own = stiffness * restricted(columns, stiffness_);
  own.conservativeResize(normal.side.size(), normal.side.size());
  normal.matrix += Eigen::SparseMatrix<double>(own.triangularView<Eigen::Lower>());
  add_lower_rows(dof, bent.transpose() * columns, at.turn_columns.transpose() * bent, normal.matrix);
  normal.side.head(dof) += columns.transpose() * pull;
  normal.side.segment(dof, ways) += at.turn_columns.transpose() * pull;
}

void MovingSystem::add_contacts(const Linearised& at, double stiffness, NormalEquations& normal) const {
  if (contacts_.empty()) return;
  const Index dof = subspace_.degrees_of_freedom();
  const Index all = normal.side.size();
  const SmallTurns small{regions_, at.turns, at.turn_columns};
  const ContactRows contacts = contact_rows_at(contacts_, contact_share(stiffness) * kContactWeight, subspace_, at.now,
                                               at.deformed.vertices - mesh_.vertices, rotations(), &small);
  const VectorXd off = contacts.right - contacts.rows.leftCols(dof) * at.now.q;
  Eigen::SparseMatrix<double> rows = contacts.rows.sparseView();
  normal.side.head(rows.cols()) += rows.transpose() * off;
  rows.conservativeResize(rows.rows(), all);
  normal.matrix += Eigen::SparseMatrix<double>((rows.transpose() * rows).triangularView<Eigen::Lower>());
}

// What holds coordinates that move nothing, turns and the pose.
void MovingSystem::add_holds(const Linearised& at, double damping, NormalEquations& normal) const {
  const Index dof = subspace_.degrees_of_freedom();
  const auto all_samples = static_cast<double>(samples());
  const double still = kHoldStill * all_samples;
  VectorXd diagonal(normal.side.size());
  diagonal << VectorXd::Constant(dof, still + damping),
      (kHoldTurns + damping) * at.turn_columns.colwise().squaredNorm().transpose(),
      VectorXd::Constant(step_.unknowns(), kHoldPose * all_samples + damping);
  normal.matrix += Eigen::SparseMatrix<double>(diagonal.asDiagonal());
  normal.side.head(dof) -= still * at.now.q;
}

MovingSystem::Solution MovingSystem::solve(const std::vector<Correspondence>& pairs, double share,
                                           const Points& scan_points, const std::vector<Pull>& pulls, const Hold& hold,
                                           const RunContext& context) {
  const Index dof = subspace_.degrees_of_freedom();
  const Index ways = regions_.freedom();
  const Linearised at = linearised(hold.around, context);
  const VertexRows rows = rows_at(at, touched_vertices(mesh_, pairs, pulls), context);
  step_.others = hold.other_scans;
  const Index all = dof + ways + step_.unknowns();
  NormalEquations normal{Eigen::SparseMatrix<double>(all, all), VectorXd::Zero(all)};
  add_regularity(at, hold.stiffness, normal);
  add_contacts(at, hold.stiffness, normal);
  add_holds(at, hold.damping, normal);
  add_data(rows, at.deformed, step_, pairs, share, scan_points, pulls, context, normal);
  // Prefers the pose to a deformation that does the same.
  MatrixXd rigid = MatrixXd::Zero(all, rigid_.cols());
  rigid.topRows(dof) = std::sqrt(kPreferPose) * (at.now.basis->columns.transpose() * rigid_);
  rigid.middleRows(dof, ways) = std::sqrt(kPreferPose) * (at.turn_columns.transpose() * rigid_);
  normal.side -= std::sqrt(kPreferPose) * rigid * (rigid_.transpose() * stacked(at.moved));

  VectorXd solved;
  if (solver_.compute(normal.matrix, rigid)) solved = solver_.solve(normal.side);
  if (solved.size() == 0 || !solved.allFinite()) {
    throw NoResultError("the fit's linear system has no finite solution");
  }
  return {moved_by(solved.head(dof + ways), at, hold.around), step_.motion(solved.tail<6>()),
          step_.other_motions(solved.tail(step_.unknowns()))};
}

VectorXd MovingSystem::moved_by(VectorXd change, const Linearised& at, const VectorXd& around) const {
  const Index dof = subspace_.degrees_of_freedom();
  const Index ways = regions_.freedom();
  VectorXd angles = change.tail(ways);
  const double largest = ways > 0 ? angles.cwiseAbs().maxCoeff() : 0;
  if (largest > kMaxTurn) angles *= kMaxTurn / largest;
  change.tail(ways) = angles;
  const VectorXd there =
      stacked(at.moved) + at.now.basis->columns * change.head(dof) + at.turn_columns * change.tail(ways);
  VectorXd result = turned(around, angles, Eigen::Map<const Points>(there.data(), samples(), 3));
  if (result.size() == 0) {  // the groups stay as they stand
    result = around;
    result.head(dof) += change.head(dof);
  }
  return result;
}

double MovingSystem::condition() const {
  return condition_estimate(
      solver_.size(), [&](const VectorXd& x) { return solver_.multiply(x); },
      [&](const VectorXd& b) { return solver_.solve(b); });
}

}  // namespace orbifit

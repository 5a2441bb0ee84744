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

LiftWeights rows_of(const LiftWeights& weights, const std::vector<int>& rows) {
  LiftWeights result(static_cast<Index>(rows.size()), weights.cols());
  Eigen::VectorXi sizes(result.rows());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    sizes[static_cast<Index>(i)] = static_cast<int>(weights.row(rows[i]).nonZeros());
  }
  result.reserve(sizes);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (LiftWeights::InnerIterator it(weights, rows[i]); it; ++it) {
      result.insert(static_cast<Index>(i), it.col()) = it.value();
    }
  }
  return result;
}

}  // namespace

MovingSystem::MovingSystem(const Subspace& subspace, const Mesh& mesh, double stretch, std::vector<Contact> contacts,
                           const RunContext& context)
    : DeformationSystem(CorotatedEnergy(subspace->sampling.points, subspace->sampling.radius, stretch)),
      subspace_(subspace),
      mesh_(mesh),
      contacts_(std::move(contacts)),
      regions_(subspace),
      stiffness_(energy_.matrix()),
      rigid_(rigid_modes(subspace->sampling.points)),
      spread_(lift_weights(mesh.vertices, subspace->sampling.points, subspace->sampling.radius, context)),
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

MovingSystem::Solution MovingSystem::solve(const std::vector<Correspondence>& pairs, double share,
                                           const Points& scan_points, const std::vector<Pull>& pulls, const Hold& hold,
                                           const RunContext& context) {
  const Index dof = subspace_.degrees_of_freedom();
  const Index ways = regions_.freedom();
  const auto all_samples = static_cast<double>(samples());
  const SubspaceState now = state_of(hold.around);
  const ConjugatedRegions::Turns turns = turns_of(hold.around);
  const Points moved = sample_displacements(subspace_, now);
  const Points& rest = subspace_->sampling.points;
  Mesh deformed;
  deformed.vertices = mesh_.vertices + vertex_displacements(subspace_, now, context);
  deformed.faces = mesh_.faces;

  // How the samples move by increments of the coordinates, and by small turns.
  const Eigen::SparseMatrix<double>& columns = now.basis->columns;
  const MatrixXd turn_columns = regions_.columns(turns, rest + moved, region_centres(subspace_, now));
  const std::vector<int> touched = touched_vertices(mesh_, pairs, pulls);
  const LiftWeights spread = rows_of(spread_, touched);
  const Points missing = deformed.vertices(touched, Eigen::all) - Points(spread * (rest + moved));
  const MatrixXd turning = applied(spread, turn_columns) + regions_.arms(turns, spread, missing);
  VertexRows rows(subspace_, *now.basis);
  rows.prepare(touched, context);
  for (std::size_t i = 0; i < touched.size(); ++i) {
    rows.extend(touched[i], static_cast<int>(dof), turning.middleRows<3>(3 * static_cast<Index>(i)));
  }

  step_.others = hold.other_scans;
  const Index all = dof + ways + step_.unknowns();
  NormalEquations data{Eigen::SparseMatrix<double>(all, all), VectorXd::Zero(all)};
  add_data(rows, deformed, step_, pairs, share, scan_points, pulls, context, data);
  struct {
    MatrixXd matrix;
    VectorXd side;
  } normal{MatrixXd(data.matrix), data.side};
  const Points pull = energy_.pull() - Points(stiffness_ * moved);
  const MatrixXd bent = hold.stiffness * applied(LiftWeights(stiffness_), turn_columns);
  normal.matrix.topLeftCorner(dof, dof) += hold.stiffness * restricted(columns, stiffness_);
  normal.matrix.block(dof, 0, ways, dof) += bent.transpose() * columns;
  normal.matrix.block(dof, dof, ways, ways) += turn_columns.transpose() * bent;
  normal.side.head(dof) += hold.stiffness * (columns.transpose() * stacked(pull));
  normal.side.segment(dof, ways) += hold.stiffness * (turn_columns.transpose() * stacked(pull));
  if (!contacts_.empty()) {
    const SmallTurns small{regions_, turns, turn_columns};
    const ContactRows contacts = contact_rows_at(contacts_, kContactWeight, subspace_, now,
                                                 deformed.vertices - mesh_.vertices, rotations(), &small);
    const VectorXd off = contacts.right - contacts.rows.leftCols(dof) * now.q;
    normal.matrix.topLeftCorner(dof + ways, dof + ways) += contacts.rows.transpose() * contacts.rows;
    normal.side.head(dof + ways) += contacts.rows.transpose() * off;
  }
  MatrixXd rigid(dof + ways, rigid_.cols());
  rigid << columns.transpose() * rigid_, turn_columns.transpose() * rigid_;
  const double still = kHoldStill * all_samples;
  normal.matrix.topLeftCorner(dof + ways, dof + ways) += kPreferPose * rigid * rigid.transpose();
  normal.side.head(dof + ways) -= kPreferPose * rigid * (rigid_.transpose() * stacked(moved));
  normal.matrix.diagonal().head(dof).array() += still + hold.damping;
  normal.side.head(dof) -= still * now.q;
  normal.matrix.diagonal().segment(dof, ways) +=
      (kHoldTurns + hold.damping) * turn_columns.colwise().squaredNorm().transpose();
  normal.matrix.diagonal().tail(step_.unknowns()).array() += kHoldPose * all_samples + hold.damping;

  matrix_ = std::move(normal.matrix);
  factor_.compute(matrix_);
  const VectorXd solved = factor_.solve(normal.side);
  if (factor_.info() != Eigen::Success || !solved.allFinite()) {
    throw NoResultError("the fit's linear system has no finite solution");
  }
  VectorXd change = solved.head(dof + ways);
  VectorXd angles = change.tail(ways);
  const double largest = ways > 0 ? angles.cwiseAbs().maxCoeff() : 0;
  if (largest > kMaxTurn) angles *= kMaxTurn / largest;
  change.tail(ways) = angles;
  const VectorXd there = stacked(moved) + columns * change.head(dof) + turn_columns * change.tail(ways);
  Solution solution;
  solution.q = turned(hold.around, angles, Eigen::Map<const Points>(there.data(), samples(), 3));
  if (solution.q.size() == 0) {  // the groups stay as they stand
    solution.q = hold.around;
    solution.q.head(dof) += change.head(dof);
  }
  solution.scan_step = step_.motion(solved.tail<6>());
  solution.other_steps = step_.other_motions(solved.tail(step_.unknowns()));
  return solution;
}

double MovingSystem::condition() const {
  return condition_estimate(
      matrix_.cols(), [&](const VectorXd& x) -> VectorXd { return matrix_.selfadjointView<Eigen::Lower>() * x; },
      [&](const VectorXd& b) -> VectorXd { return factor_.solve(b); });
}

}  // namespace orbifit

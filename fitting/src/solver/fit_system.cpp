#include "solver/fit_system.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "orbifit/model/errors.h"

#include "basis/subspace_parts.h"
#include "deformation/corotation.h"
#include "registration/alignment.h"
#include "solver/condition.h"
#include "solver/data_normal.h"
#include "solver/rigid_modes.h"

namespace orbifit {

namespace {

using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

constexpr double kAnchor = 0.1;     // of a sample to the reference: over a few radii from what is seen it stays there
constexpr double kMaxGrowth = 1.1;  // in one iteration

Sparse diagonal_matrix(const VectorXd& entries) {
  return Sparse(entries.asDiagonal());
}

}  // namespace

FitSystem::FitSystem(const Subspace& subspace, const Mesh& mesh, double stretch, std::vector<Contact> contacts,
                     Points reference)
    : DeformationSystem(CorotatedEnergy(subspace->sampling.points, subspace->sampling.radius, stretch, reference,
                                        reference.rows() > 0 ? kAnchor : 0),
                        reference),
      subspace_(subspace),
      rows_(subspace, subspace->basis),
      mesh_(mesh),
      step_{bounding_box_centre(mesh.vertices), diagonal(mesh.vertices)},
      contacts_(std::move(contacts), subspace, kContactWeight),
      stiffness_matrix_(restricted(subspace->basis.columns, energy_.matrix()).triangularView<Eigen::Lower>()),
      contact_matrix_(contacts_.gram().triangularView<Eigen::Lower>()),
      hold_matrix_(diagonal_matrix(VectorXd::Constant(unknowns(), kHoldStill * static_cast<double>(samples())))),
      rigid_(std::sqrt(kPreferPose) * (subspace->basis.columns.transpose() * rigid_modes(subspace->sampling.points))) {
  if (reference_.rows() > 0) reference_pull_ = energy_.matrix() * reference_;
}

double FitSystem::contact_energy(const VectorXd& q) const {
  return contacts_.value(q, [&](int sample) { return rotations()[static_cast<std::size_t>(sample)]; });
}

Points FitSystem::samples_at(const VectorXd& q) const {
  return sample_displacements(subspace_, q);
}

Points FitSystem::vertices_at(const VectorXd& q, const RunContext& context) const {
  return vertex_displacements(subspace_, {q, nullptr}, context);
}

FitSystem::Solution FitSystem::solve(const std::vector<Correspondence>& pairs, double share, const Points& scan_points,
                                     const std::vector<Pull>& pulls, const Hold& hold, const RunContext& context) {
  const Eigen::Index dof = subspace_.degrees_of_freedom();
  const auto all_samples = static_cast<double>(samples());
  rows_.prepare(touched_vertices(mesh_, pairs, pulls), context);
  step_.grows = hold.scale_open;
  step_.others = hold.other_scans;
  const Eigen::Index all = dof + step_.unknowns();
  VectorXd diagonal(all);
  diagonal << VectorXd::Constant(dof, hold.damping),
      VectorXd::Constant(all - dof, kHoldPose * all_samples + hold.damping);
  const double firm = contact_share(hold.stiffness);
  NormalEquations normal{hold.stiffness * stiffness_matrix_ + firm * contact_matrix_ + hold_matrix_,
                         VectorXd::Zero(all)};
  if (step_.grows) {
    const double cost = hold.stiffness * growth_cost(1) / (step_.length * step_.length);
    const Eigen::Index growth = all - step_.common();
    diagonal[growth] += cost;
    normal.side[growth] -= cost * step_.length * hold.grown;
  }
  normal.matrix.conservativeResize(all, all);
  normal.matrix += diagonal_matrix(diagonal);
  add_data(rows_, mesh_, step_, pairs, share, scan_points, pulls, context, normal);
  Points pull = energy_.pull();
  if (reference_pull_.rows() > 0) pull += reference_pull_;
  normal.side.head(dof) += hold.stiffness * (subspace_->basis.columns.transpose() * stacked(pull));
  if (hold.damping > 0) normal.side.head(dof) += hold.damping * hold.around;
  VectorXd contact_pull = VectorXd::Zero(dof);
  contacts_.add_pull([&](int sample) { return rotations()[static_cast<std::size_t>(sample)]; }, contact_pull);
  normal.side.head(dof) += firm * contact_pull;

  Eigen::MatrixXd rigid = Eigen::MatrixXd::Zero(all, rigid_.cols());
  rigid.topRows(dof) = rigid_;
  VectorXd solved;
  if (solver_.compute(normal.matrix, rigid)) solved = solver_.solve(normal.side);
  if (solved.size() == 0 || !solved.allFinite()) {
    throw NoResultError("the fit's linear system has no finite solution");
  }
  Solution solution;
  if (step_.grows) {
    solution.growth = std::clamp(1 + solved[solved.size() - step_.common()] / step_.length, 1 / kMaxGrowth, kMaxGrowth);
  }
  solution.q = solved.head(dof) / solution.growth;
  solution.scan_step = step_.motion(solved.tail<6>());
  solution.other_steps = step_.other_motions(solved.tail(step_.unknowns()));
  return solution;
}

double FitSystem::condition() const {
  return condition_estimate(
      solver_.size(), [&](const VectorXd& x) { return solver_.multiply(x); },
      [&](const VectorXd& b) { return solver_.solve(b); });
}

}  // namespace orbifit

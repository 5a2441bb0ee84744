#include "solver/fit_system.h"

#include <algorithm>
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

constexpr double kMaxGrowth = 1.1;  // in one iteration

}  // namespace

FitSystem::FitSystem(const Subspace& subspace, const Mesh& mesh, double stretch, std::vector<Contact> contacts)
    : DeformationSystem(CorotatedEnergy(subspace->sampling.points, subspace->sampling.radius, stretch)),
      subspace_(subspace),
      rows_(subspace, subspace->basis),
      mesh_(mesh),
      step_{bounding_box_centre(mesh.vertices), diagonal(mesh.vertices)},
      contacts_(std::move(contacts), subspace, kContactWeight),
      stiffness_matrix_(restricted(subspace->basis.columns, energy_.matrix())) {
  const Eigen::MatrixXd rigid = subspace->basis.columns.transpose() * rigid_modes(subspace->sampling.points);
  hold_matrix_ = kPreferPose * rigid * rigid.transpose();
  hold_matrix_.diagonal().array() += kHoldStill * static_cast<double>(samples());
  contacts_.add_gram(hold_matrix_);
}

double FitSystem::contact_energy(const Eigen::VectorXd& q) const {
  return contacts_.value(q, [&](int sample) { return rotations()[static_cast<std::size_t>(sample)]; });
}

Points FitSystem::samples_at(const Eigen::VectorXd& q) const {
  return sample_displacements(subspace_, q);
}

Points FitSystem::vertices_at(const Eigen::VectorXd& q, const RunContext& context) const {
  return vertex_displacements(subspace_, {q, nullptr}, context);
}

FitSystem::Solution FitSystem::solve(const std::vector<Correspondence>& pairs, double share, const Points& scan_points,
                                     const std::vector<Pull>& pulls, const Hold& hold, const RunContext& context) {
  const Eigen::Index dof = subspace_.degrees_of_freedom();
  const auto all_samples = static_cast<double>(samples());
  rows_.prepare(touched_vertices(mesh_, pairs, pulls), context);
  step_.grows = hold.scale_open;
  step_.others = hold.other_scans;
  DataNormal normal = data_normal(rows_, dof, mesh_, step_, pairs, share, scan_points, pulls, context);
  normal.matrix.topLeftCorner(dof, dof).triangularView<Eigen::Lower>() +=
      hold.stiffness * stiffness_matrix_ + hold_matrix_;
  normal.matrix.diagonal().head(dof).array() += hold.damping;
  normal.matrix.diagonal().tail(step_.unknowns()).array() += kHoldPose * all_samples + hold.damping;
  if (step_.grows) {
    const double cost = hold.stiffness * growth_cost(1) / (step_.length * step_.length);
    const Eigen::Index growth = normal.side.size() - step_.common();
    normal.matrix(growth, growth) += cost;
    normal.side[growth] -= cost * step_.length * hold.grown;
  }
  normal.side.head(dof) += hold.stiffness * (subspace_->basis.columns.transpose() * stacked(energy_.pull()));
  if (hold.damping > 0) normal.side.head(dof) += hold.damping * hold.around;
  Eigen::VectorXd contact_pull = Eigen::VectorXd::Zero(dof);
  contacts_.add_pull([&](int sample) { return rotations()[static_cast<std::size_t>(sample)]; }, contact_pull);
  normal.side.head(dof) += contact_pull;

  matrix_ = std::move(normal.matrix);
  factor_.compute(matrix_);
  const Eigen::VectorXd solved = factor_.solve(normal.side);
  if (factor_.info() != Eigen::Success || !solved.allFinite()) {
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
      matrix_.cols(),
      [&](const Eigen::VectorXd& x) -> Eigen::VectorXd { return matrix_.selfadjointView<Eigen::Lower>() * x; },
      [&](const Eigen::VectorXd& b) -> Eigen::VectorXd { return factor_.solve(b); });
}

}  // namespace orbifit

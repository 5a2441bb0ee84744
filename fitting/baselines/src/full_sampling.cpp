#include "orbifit/baselines/full_sampling.h"

#include "orbifit/baselines/symmetry_constraints.h"
#include "orbifit/model/errors.h"

#include "baseline_fit.h"
#include "basis/subspace_parts.h"
#include "fit_trial.h"
#include "full_editing.h"
#include "full_system.h"
#include "plain_weights.h"

namespace orbifit {

namespace {

// The largest residual of three rows.
double worst_constraint(const Subspace& subspace, const Eigen::VectorXd& unknowns) {
  const Eigen::SparseMatrix<double> constraints = symmetry_constraints(subspace);
  if (constraints.rows() == 0) return 0;
  Eigen::VectorXd all = Eigen::VectorXd::Zero(constraints.cols());
  all.head(unknowns.size()) = unknowns;
  const Eigen::VectorXd left = constraints * all;
  return Eigen::Map<const Points>(left.data(), left.size() / 3, 3).rowwise().norm().maxCoeff() / subspace->diagonal;
}

}  // namespace

std::string to_string(FullSymmetry symmetry) {
  return symmetry == FullSymmetry::none ? "none" : symmetry == FullSymmetry::soft ? "soft" : "constrained";
}

void FullSamplingOptions::validate() const {
  fit.validate();
  require(weight > 0, "weight", weight, "positive");
  validate_editing(alpha, edit_iterations);
}

FitResult fit_full_sampling(const FitInput& input, const FullSamplingOptions& options, const RunContext& context) {
  options.validate();
  FitResult result;
  StageClock clock(result.times);
  PlacedScan start;
  const bool edit = by_handles_alone(input);
  if (!edit) start = baseline_start(input, options.fit, context);
  const Subspace subspace = plain_subspace(input, options.fit, context);
  result.samples = static_cast<int>(subspace->sampling.points.rows());
  Points displacements;
  if (edit) {
    clock.finished("prepare");
    result.pose = input.pose;
    result.q = edit_full_sampling(subspace, input.mesh, input.handles, options, result);
    displacements = plain_weights(subspace) * Eigen::Map<const Points>(result.q.data(), result.samples, 3);
  } else {
    FullSystem system(subspace, input.mesh, options.fit.stretch, options.symmetry, options.weight);
    clock.finished("prepare");
    run_fit(system, {start.pose, Eigen::VectorXd::Zero(system.unknowns())}, 0, input, start, options.fit, context,
            result);
    displacements = system.vertices_at(result.q, context);
  }
  clock.finished("fit");
  result.degrees_of_freedom = static_cast<int>(result.q.size());
  finish_baseline(input, options.fit, displacements, edit ? nullptr : &start, context, result);
  const Eigen::Index carriers = result.q.size() - 3 * Eigen::Index{result.samples};
  carry_annotation(input, &subspace, result.q.tail(carriers), result);
  result.field_residual = worst_constraint(subspace, result.q);
  return result;
}

}  // namespace orbifit

#include "fit_trial.h"

#include <utility>

#include "assessment/fit_assessment.h"
#include "basis/subspace_parts.h"
#include "registration/alignment.h"
#include "solver/moving_system.h"

namespace orbifit {

void run_fit(DeformationSystem& system, FitState state, int first_level, const FitInput& input, const PlacedScan& start,
             const FitOptions& options, const RunContext& context, FitResult& result) {
  FitLoop loop(input, start, system, options, context);
  result.stopped_because = loop.run(state, first_level, start.scale_open, result.iterations);
  result.iterations_in_all = static_cast<int>(result.iterations.size());
  if (options.condition && !result.iterations.empty()) result.condition = system.condition();
  result.pose = state.pose;
  result.q = std::move(state.q);
  result.others = std::move(state.others);
}

namespace {

// Once the groups have floated to where they fit best, they turn as well: a start from rest would let parts that are
// still far from the scan turn every way. Stiff to begin with: what floating groups have pushed along a surface, for
// want of a turn, comes back, which no point of the scan asks for.
void let_groups_turn(const FitInput& input, const PlacedScan& start, const FitSystem& floating,
                     const FitOptions& options, const RunContext& context, FitResult& result) {
  MovingSystem system(floating.subspace(), input.mesh, options.stretch, floating.contacts(), context);
  if (!system.turns()) return;
  FitOptions more = options;
  more.max_iterations += result.iterations_in_all;
  run_fit(system, {result.pose, system.at_rest(result.q), result.others}, 0, input, start, more, context, result);
  const SubspaceState state = system.state_of(result.q);
  result.q = state.q;
  result.basis = state.basis;
}

}  // namespace

FitResult fit_from(FitState state, int first_level, const FitInput& input, const PlacedScan& start, FitSystem& system,
                   const FitOptions& options, const RunContext& context) {
  FitResult result;
  const Subspace& subspace = system.subspace();
  system.unturn();
  run_fit(system, std::move(state), first_level, input, start, options, context, result);
  if (subspace->mode == GroupMode::moving) let_groups_turn(input, start, system, options, context, result);
  result.samples = static_cast<int>(subspace->sampling.points.rows());
  result.degrees_of_freedom = subspace.degrees_of_freedom();
  result.subspace = subspace;
  result.overlap = start.overlap;
  result.torn_off = start.torn_off;

  Mesh deformed = input.mesh;
  const SubspaceState found{result.q, result.basis};
  deformed.vertices += vertex_displacements(subspace, found, context);
  result.rest_annotation = input.annotation;
  result.annotation = transformed(deformed_annotation(input.annotation, subspace, found, deformed), result.pose);
  deformed.vertices = from_template(result.pose, deformed.vertices);
  result.fitted = std::move(deformed);
  result.annotation.mesh_diagonal = diagonal(result.fitted.vertices);
  const PreparedScan put = with_others_moved(start, result.others);
  MovingSurface surface = moving_template(start, input.mesh);
  surface.move(result.fitted, context);
  assess_fit(input, put, start.views->silhouette.seen(), surface, options, context, result);
  return result;
}

FitResult fit_from(const FitInput& input, const PlacedScan& start, FitSystem& system, const FitOptions& options,
                   const RunContext& context) {
  const FitState rest{start.pose, Eigen::VectorXd::Zero(system.unknowns())};
  return fit_from(rest, 0, input, start, system, options, context);
}

void take_over(FitResult found, FitResult& result) {
  found.iterations_in_all += result.iterations_in_all;
  found.placements = std::move(result.placements);
  found.groups = std::move(result.groups);
  found.dropped = std::move(result.dropped);
  found.other_used = std::move(result.other_used);
  found.levels = std::move(result.levels);
  result = std::move(found);
}

}  // namespace orbifit

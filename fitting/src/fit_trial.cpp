#include "fit_trial.h"

#include <utility>

#include "orbifit/fitting/alignment.h"

#include "fit_assessment.h"
#include "fit_system.h"

namespace orbifit {

void run_fit(DeformationSystem& system, FitState state, int first_level, const FitInput& input, const PlacedScan& start,
             const FitOptions& options, const RunContext& context, FitResult& result) {
  FitLoop loop(input, start.scan, *start.views, system, options, context);
  result.stopped_because = loop.run(state, first_level, result.iterations);
  result.iterations_in_all = static_cast<int>(result.iterations.size());
  if (options.condition && !result.iterations.empty()) result.condition = system.condition();
  result.pose = state.pose;
  result.q = std::move(state.q);
}

FitResult fit_from(FitState state, int first_level, const FitInput& input, const PlacedScan& start,
                   const Subspace& subspace, const FitOptions& options, const RunContext& context) {
  FitResult result;
  FitSystem system(subspace, input.mesh, options.stretch);
  run_fit(system, std::move(state), first_level, input, start, options, context, result);
  result.samples = static_cast<int>(subspace.sampling.points.rows());
  result.degrees_of_freedom = subspace.degrees_of_freedom();
  result.used_fraction = start.used_fraction;
  result.torn_off = start.torn_off;

  Mesh deformed = input.mesh;
  deformed.vertices += vertex_displacements(subspace, result.q);
  result.rest_annotation = input.annotation;
  result.annotation = transformed(carried_annotation(input.annotation, subspace, result.q, deformed), result.pose);
  deformed.vertices = from_template(result.pose, deformed.vertices);
  result.fitted = std::move(deformed);
  result.annotation.mesh_diagonal = diagonal(result.fitted.vertices);
  assess_fit(input, start.scan, options, context, result);
  return result;
}

FitResult fit_from(const FitInput& input, const PlacedScan& start, const Subspace& subspace, const FitOptions& options,
                   const RunContext& context) {
  const FitState rest{start.pose, Eigen::VectorXd::Zero(subspace.degrees_of_freedom())};
  return fit_from(rest, 0, input, start, subspace, options, context);
}

}  // namespace orbifit

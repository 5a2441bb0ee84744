#include "fit_trial.h"

#include <utility>

#include "fit_assessment.h"
#include "fit_system.h"

namespace orbifit {

FitResult fit_from(FitState state, int first_level, const FitInput& input, const PlacedScan& start,
                   const Subspace& subspace, const FitOptions& options, const RunContext& context) {
  FitResult result;
  FitSystem system(subspace, input.mesh, options.stretch);
  FitLoop loop(input, start.scan, *start.views, system, options, context);
  result.stopped_because = loop.run(state, first_level, result.iterations);
  if (options.condition && !result.iterations.empty()) result.condition = system.condition();
  result.iterations_in_all = static_cast<int>(result.iterations.size());
  result.pose = state.pose;
  result.q = std::move(state.q);
  result.samples = static_cast<int>(subspace.sampling.points.rows());
  result.degrees_of_freedom = subspace.degrees_of_freedom();
  result.used_fraction = start.used_fraction;
  result.torn_off = start.torn_off;

  Mesh deformed = input.mesh;
  deformed.vertices += vertex_displacements(subspace, result.q);
  result.rest_annotation = input.annotation;
  result.annotation = transformed(carried_annotation(input.annotation, subspace, result.q, deformed), result.pose);
  for (Eigen::Index v = 0; v < deformed.vertices.rows(); ++v) {
    deformed.vertices.row(v) = result.pose(deformed.vertices.row(v).transpose()).transpose();
  }
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

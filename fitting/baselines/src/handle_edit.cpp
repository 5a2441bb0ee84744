#include "orbifit/baselines/handle_edit.h"

#include "orbifit/model/errors.h"

#include "baseline_fit.h"
#include "basis/subspace_parts.h"

namespace orbifit {

FitResult edit_by_handles(const FitInput& input, const FitOptions& options, const RunContext& context) {
  constexpr double kAlpha = 100;
  constexpr int kIterations = 10;
  if (input.handles.empty()) throw InputError("", "handles", "there are none");
  FitResult result;
  StageClock clock(result.times);
  const Subspace subspace = build_subspace(input.mesh, input.annotation, options.subspace, context);
  const SubspaceState state = edit_in_subspace(subspace, input, kAlpha, kIterations, context, clock, result);
  clock.finished("fit");
  result.pose = input.pose;
  result.samples = static_cast<int>(subspace->sampling.points.rows());
  result.degrees_of_freedom = subspace.degrees_of_freedom();
  const Points displacements = vertex_displacements(subspace, state, context);
  finish_baseline(input, options, displacements, nullptr, context, result);
  Mesh deformed = input.mesh;
  deformed.vertices += displacements;
  result.rest_annotation = input.annotation;
  result.annotation = transformed(deformed_annotation(input.annotation, subspace, state, deformed), result.pose);
  return result;
}

}  // namespace orbifit

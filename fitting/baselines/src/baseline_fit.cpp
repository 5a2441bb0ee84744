#include "baseline_fit.h"

#include <chrono>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "orbifit/model/errors.h"
#include "orbifit/subspace/deformer.h"

#include "assessment/fit_assessment.h"
#include "basis/subspace_parts.h"
#include "registration/alignment.h"
#include "start/fit_starts.h"

namespace orbifit {

bool by_handles_alone(const FitInput& input) {
  if (input.scan.points.rows() > 0) return false;
  if (input.handles.empty()) throw InputError("", "scan", "it has no points, and there are no handles");
  return true;
}

PlacedScan baseline_start(const FitInput& input, const FitOptions& options, const RunContext& context) {
  std::vector<StageTime> times;
  StageClock clock(times);
  return std::move(find_starts(input, options, false, context, clock).places.front());
}

void validate_editing(double alpha, int iterations) {
  require(alpha > 0, "alpha", alpha, "positive");
  require(iterations >= 1, "edit_iterations", iterations, "at least 1");
}

Subspace plain_subspace(const FitInput& input, const FitOptions& options, const RunContext& context) {
  SubspaceOptions plain = options.subspace;
  plain.lift = LiftKind::paper;
  return build_subspace(input.mesh, input.annotation, plain, context);
}

SubspaceState edit_in_subspace(const Subspace& subspace, const FitInput& input, double alpha, int iterations,
                               const RunContext& context, StageClock& clock, FitResult& result) {
  Deformer deformer(subspace, input.mesh, {.contacts = false}, context);  // as the methods compared with
  deformer.set_handles(input.handles, alpha);
  std::vector<Motion> motions;
  for (const Handle& handle : input.handles) motions.push_back(handle.motion);
  clock.finished("prepare");
  const auto start = std::chrono::steady_clock::now();
  Deformation found = deformer.solve(motions, iterations);
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
  FitIteration each;
  each.change = found.last_change / subspace->diagonal;
  each.seconds = taken.count() / iterations;
  result.iterations.assign(static_cast<std::size_t>(iterations), each);
  result.q = found.state.q;
  return std::move(found.state);
}

void finish_baseline(const FitInput& input, const FitOptions& options, const Points& displacements,
                     const PlacedScan* start, const RunContext& context, FitResult& result) {
  result.fitted = input.mesh;
  result.fitted.vertices = from_template(result.pose, input.mesh.vertices + displacements);
  result.iterations_in_all = static_cast<int>(result.iterations.size());
  if (start != nullptr) {
    result.overlap = start->overlap;
    assess_fit(input, start->scan, start->views->silhouette.seen(), options, context, result);
    result.converged = result.inlier_ratio * result.overlap >= options.min_inlier_ratio;
    return;
  }
  result.landmark_rms = pulls_rms(input, result);
  result.converged = true;
  result.stopped_because = "the iterations asked for are done";
}

void carry_annotation(const FitInput& input, const Subspace* subspace, const Eigen::VectorXd& carriers,
                      FitResult& result) {
  result.rest_annotation = input.annotation;
  SymmetryAnnotation carried = input.annotation;
  if (subspace != nullptr && carriers.size() > 0) {
    // One coordinate, by which the carriers go where they are.
    const auto basis = std::make_shared<ConjugatedBasis>();
    basis->carried = carriers;
    basis->carried_offset = Eigen::VectorXd::Zero(carriers.size());
    carried =
        deformed_annotation(input.annotation, *subspace, SubspaceState{Eigen::VectorXd::Ones(1), basis}, input.mesh);
  }
  result.annotation = transformed(carried, result.pose);
  result.annotation.mesh_diagonal = diagonal(result.fitted.vertices);
}

}  // namespace orbifit

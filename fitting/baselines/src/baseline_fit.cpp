#include "baseline_fit.h"

#include <memory>
#include <utility>
#include <vector>

#include "orbifit/model/errors.h"

#include "fit_assessment.h"
#include "fit_starts.h"

namespace orbifit {

bool by_handles_alone(const FitInput& input) {
  if (input.scan.points.rows() > 0) return false;
  if (input.handles.empty()) throw InputError("", "scan", "it has no points, and there are no handles");
  return true;
}

PlacedScan baseline_start(const FitInput& input, const FitOptions& options, const RunContext& context) {
  std::vector<StageTime> times;
  StageClock clock(times);
  return std::move(find_starts(input, options, context, clock).places.front());
}

void finish_baseline(const FitInput& input, const FitOptions& options, const Points& displacements,
                     const PlacedScan* start, const RunContext& context, FitResult& result) {
  result.fitted = input.mesh;
  for (Eigen::Index v = 0; v < displacements.rows(); ++v) {
    const Eigen::Vector3d moved = (input.mesh.vertices.row(v) + displacements.row(v)).transpose();
    result.fitted.vertices.row(v) = result.pose(moved).transpose();
  }
  result.iterations_in_all = static_cast<int>(result.iterations.size());
  if (start != nullptr) {
    result.used_fraction = start->used_fraction;
    assess_fit(input, start->scan, options, context, result);
    result.converged = result.inlier_fraction * result.used_fraction >= options.least_inliers;
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
    const auto basis = std::make_shared<CarriedBasis>();
    basis->carried = carriers;
    basis->carried_offset = Eigen::VectorXd::Zero(carriers.size());
    carried =
        carried_annotation(input.annotation, *subspace, SubspaceState{Eigen::VectorXd::Ones(1), basis}, input.mesh);
  }
  result.annotation = transformed(carried, result.pose);
  result.annotation.mesh_diagonal = diagonal(result.fitted.vertices);
}

}  // namespace orbifit

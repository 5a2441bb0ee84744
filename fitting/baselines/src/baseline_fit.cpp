#include "baseline_fit.h"

#include <cmath>
#include <memory>

#include "orbifit/fitting/alignment.h"
#include "orbifit/fitting/placement.h"
#include "orbifit/model/errors.h"

#include "fit_assessment.h"
#include "pulls.h"

namespace orbifit {

void StageClock::finished(const std::string& stage, FitResult& result) {
  const auto now = std::chrono::steady_clock::now();
  result.times.push_back({stage, std::chrono::duration<double>(now - last_).count()});
  last_ = now;
}

bool by_handles_alone(const FitInput& input) {
  if (input.scan.points.rows() > 0) return false;
  if (input.handles.empty()) throw InputError("", "scan", "it has no points, and there are no handles");
  return true;
}

PlacedScan baseline_start(const FitInput& input, const FitOptions& options, const RunContext& context) {
  ScanPreparationOptions preparation;
  preparation.most_points = options.scan_points;
  PlacedScan start;
  bool placed = false;
  if (options.place && input.landmarks.empty() && input.handles.empty()) {
    const auto found = find_placements(input.mesh, input.scan, options.placement, context, input.pose);
    if (!found.empty()) {
      auto best =
          placed_scan(input.mesh, input.scan, found.front().pose, input.pose, options.placement, preparation, context);
      placed = best.has_value();
      if (best) start = std::move(*best);
    }
  }
  if (!placed) {
    start.scan = prepare_scan(input.scan, preparation, context);
    start.pose = input.pose;
    if (!input.landmarks.empty()) {
      start.pose = align_landmarks(input.mesh, input.landmarks);
    } else if (options.align && input.handles.empty()) {
      start.pose = align_rigidly(input.mesh, start.scan, input.pose, context);
    }
  }
  start.views = std::make_shared<const ScanViews>(input.mesh, input.scan, start.scan, context);
  return start;
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
  const auto pulls = pulls_towards(input, result.pose, 1);
  double missed = 0;
  for (const Pull& pull : pulls) {
    missed += (result.fitted.vertices.row(pull.vertex).transpose() - result.pose(pull.target)).squaredNorm();
  }
  result.landmark_rms = std::sqrt(missed / static_cast<double>(pulls.size())) / diagonal(result.fitted.vertices);
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

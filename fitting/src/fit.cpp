#include "orbifit/fitting/fit.h"

#include <chrono>
#include <utility>

#include "orbifit/fitting/alignment.h"
#include "orbifit/fitting/scan_preparation.h"
#include "orbifit/model/errors.h"
#include "orbifit/subspace/displacement_field.h"

#include "fit_assessment.h"
#include "fit_loop.h"
#include "placed_scan.h"

namespace orbifit {

namespace {

// Share of explained points of a scan from which what is not the template's has been taken: a scan of something else,
// onto which the template was put as well as can be, leaves more.
constexpr double kLeastOfPlaced = 0.8;
class Stopwatch {
 public:
  explicit Stopwatch(std::vector<StageTime>& times) : times_(times) {}

  void finished(const std::string& stage) {
    const auto now = std::chrono::steady_clock::now();
    times_.push_back({stage, std::chrono::duration<double>(now - last_).count()});
    last_ = now;
  }

 private:
  std::vector<StageTime>& times_;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

void require(bool holds, const std::string& field, double value, const std::string& rule) {
  if (!holds) throw UsageError(field + " is " + std::to_string(value) + "; it must be " + rule);
}

}  // namespace

void FitOptions::validate() const {
  subspace.validate();
  placement.validate();
  require(levels >= 1, "levels", levels, "at least 1");
  require(iterations >= 1, "iterations", iterations, "at least 1");
  require(most_iterations >= levels * iterations, "most_iterations", most_iterations,
          "at least levels * iterations = " + std::to_string(levels * iterations));
  require(last_stiffness > 0, "last_stiffness", last_stiffness, "positive");
  require(first_stiffness > last_stiffness, "first_stiffness", first_stiffness, "more than last_stiffness");
  require(stretch >= 0, "stretch", stretch, "0 or more");
  require(trim > 0 && trim <= 1, "trim", trim, "in (0, 1]");
  require(scan_points >= 10, "scan_points", scan_points, "at least 10");
  require(landmark_weight > 0, "landmark_weight", landmark_weight, "positive");
  require(inlier_distance > 0, "inlier_distance", inlier_distance, "positive");
  require(least_inliers >= 0 && least_inliers <= 1, "least_inliers", least_inliers, "in [0, 1]");
}

FitResult fit(const FitInput& input, const FitOptions& options, const RunContext& context) {
  options.validate();
  FitResult result;
  Stopwatch watch(result.times);

  ScanPreparationOptions preparation;
  preparation.most_points = options.scan_points;
  FitState state{input.pose, {}};
  PreparedScan scan;
  if (options.place && input.landmarks.empty() && input.handles.empty()) {
    PlacedScan placed = place_in_scan(input.mesh, input.scan, input.pose, options.placement, preparation, context);
    scan = std::move(placed.scan);
    state.pose = placed.pose;
    result.placements = std::move(placed.placements);
    result.used_fraction = placed.used_fraction;
  } else {
    scan = prepare_scan(input.scan, preparation, context);
  }
  watch.finished(result.placements.empty() ? "scan" : "placement");

  if (!input.landmarks.empty()) {
    state.pose = align_landmarks(input.mesh, input.landmarks);
  } else if (options.align && result.placements.empty() && input.handles.empty()) {
    state.pose = align_rigidly(input.mesh, scan, input.pose, context);
  }
  watch.finished("alignment");

  const Subspace subspace = build_subspace(input.mesh, input.annotation, options.subspace, context);
  state.q = Eigen::VectorXd::Zero(subspace.degrees_of_freedom());
  result.samples = static_cast<int>(subspace.sampling.points.rows());
  result.degrees_of_freedom = subspace.degrees_of_freedom();
  watch.finished("subspace");

  FitLoop loop(input, scan, subspace, options, context);
  result.stopped_because = loop.run(state, result.iterations);
  watch.finished("fit");

  Mesh deformed = input.mesh;
  deformed.vertices += vertex_displacements(subspace, state.q);
  result.pose = state.pose;
  result.q = state.q;
  result.fitted = deformed;
  for (Eigen::Index v = 0; v < deformed.vertices.rows(); ++v) {
    result.fitted.vertices.row(v) = state.pose(deformed.vertices.row(v).transpose()).transpose();
  }
  result.annotation = transformed(carried_annotation(input.annotation, subspace, state.q, deformed), state.pose);
  result.annotation.mesh_diagonal = diagonal(result.fitted.vertices);
  assess_fit(input, scan, options, result);
  for (std::size_t i = 0; i < input.annotation.regions.size(); ++i) {
    const Residual residual =
        field_residual(subspace, input.mesh, input.annotation.regions[i], static_cast<int>(i), state.q, context);
    result.field_residual = std::max(result.field_residual, residual.max);
  }
  watch.finished("assessment");

  const double explained = result.inlier_fraction * result.used_fraction;
  result.converged = !result.iterations.empty() && explained >= options.least_inliers &&
                     (result.placements.empty() || result.inlier_fraction >= kLeastOfPlaced);
  if (!result.iterations.empty() && !result.converged) {
    result.stopped_because +=
        "; only " + std::to_string(static_cast<int>(100 * explained)) + " % of the scan is explained";
  }
  return result;
}

}  // namespace orbifit

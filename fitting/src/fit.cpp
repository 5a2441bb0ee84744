#include "orbifit/fitting/fit.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>
#include <utility>

#include <Eigen/Cholesky>

#include "orbifit/fitting/alignment.h"
#include "orbifit/fitting/correspondences.h"
#include "orbifit/fitting/scan_preparation.h"
#include "orbifit/model/errors.h"
#include "orbifit/subspace/closable.h"
#include "orbifit/subspace/corotation.h"
#include "orbifit/subspace/displacement_field.h"

#include "fit_assessment.h"
#include "fit_loop.h"
#include "fit_system.h"
#include "placed_scan.h"

namespace orbifit {

namespace {

// Share of explained points of a scan from which what is not the template's has been taken: a scan of something else,
// onto which the template was put as well as can be, leaves more.
constexpr double kLeastOfPlaced = 0.8;
constexpr double kLeastSeen = 0.04;    // of the fitted surface: an edge lies along any line
constexpr double kWell = 0.995;        // confidence from which another scale is not tried,
constexpr double kOtherScale = 0.02;   // which must differ so much, by its logarithm,
constexpr double kSameKind = 0.4;      // and not more than shapes of one kind do,
constexpr double kWorthwhile = 0.005;  // and explain so much more

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
  require(tie > 0 && tie <= 1, "tie", tie, "in (0, 1]");
  require(most_tied >= 1, "most_tied", most_tied, "at least 1");
  require(trim > 0 && trim <= 1, "trim", trim, "in (0, 1]");
  require(scan_points >= 10, "scan_points", scan_points, "at least 10");
  require(landmark_weight > 0, "landmark_weight", landmark_weight, "positive");
  require(inlier_distance > 0, "inlier_distance", inlier_distance, "positive");
  require(least_inliers >= 0 && least_inliers <= 1, "least_inliers", least_inliers, "in [0, 1]");
}

namespace {

// Where the fit may start from: one place, or several that the scan supports about as well.
std::vector<PlacedScan> starts_of(const FitInput& input, const FitOptions& options, const RunContext& context,
                                  FitResult& result, Stopwatch& watch) {
  ScanPreparationOptions preparation;
  preparation.most_points = options.scan_points;
  std::vector<PlacedScan> starts;
  const bool place = options.place && input.landmarks.empty() && input.handles.empty();
  if (place) {
    std::vector<Placement> found = find_placements(input.mesh, input.scan, options.placement, context, input.pose);
    for (const Placement& each : found) {
      if (static_cast<int>(starts.size()) == options.most_tied) break;
      if (each.score() < options.tie * found.front().score()) break;
      auto placed = placed_scan(input.mesh, input.scan, each.pose, input.pose, options.placement, preparation, context);
      if (placed) starts.push_back(std::move(*placed));
    }
    if (!starts.empty()) result.placements = std::move(found);
    watch.finished("placement");
  }
  if (starts.empty()) {
    starts.push_back({prepare_scan(input.scan, preparation, context), input.pose, 1, {}});
    watch.finished("scan");
    if (!input.landmarks.empty()) {
      starts.front().pose = align_landmarks(input.mesh, input.landmarks);
    } else if (options.align && input.handles.empty()) {
      starts.front().pose = align_rigidly(input.mesh, starts.front().scan, input.pose, context);
    }
    watch.finished("alignment");
  }
  for (PlacedScan& start : starts) {
    start.views = std::make_shared<const ScanViews>(input.mesh, input.scan, start.scan, context);
  }
  return starts;
}

// The same with the scale that brings the template as it is nearest to the scan. Lengths of which the shape has more,
// such as a taller back, take a fit at the template's scale to the wrong slat; from there it may find the right one.
PlacedScan rescaled(const FitInput& input, const PlacedScan& start) {
  PlacedScan result = start;
  std::vector<int> all(static_cast<std::size_t>(start.scan.points.rows()));
  std::iota(all.begin(), all.end(), 0);
  result.pose = align_with_scale(input.mesh, MatchSurface(input.mesh), start.scan, all, start.pose, {});
  return result;
}

// A deformation of the template within a subspace, and how it was found.
struct Deformation {
  FitState state;
  std::vector<FitIteration> iterations;
  std::string stopped_because;
  double condition = 0;
  Mesh deformed;  // in the template's frame
  Mesh fitted;    // in the scan's
};

// \param state  where to begin \param first_level  of the stiffness: a state that is deformed already starts softer
Deformation deformation_from(FitState state, int first_level, const FitInput& input, const PlacedScan& start,
                             const Subspace& subspace, const FitOptions& options, const RunContext& context) {
  Deformation result;
  result.state = std::move(state);
  FitSystem system(subspace, input.mesh, options.stretch);
  FitLoop loop(input, start.scan, *start.views, system, options, context);
  result.stopped_because = loop.run(result.state, first_level, result.iterations);
  if (options.condition && !result.iterations.empty()) result.condition = system.condition();
  result.deformed = input.mesh;
  result.deformed.vertices += vertex_displacements(subspace, result.state.q);
  result.fitted = result.deformed;
  for (Eigen::Index v = 0; v < result.fitted.vertices.rows(); ++v) {
    result.fitted.vertices.row(v) = result.state.pose(result.deformed.vertices.row(v).transpose()).transpose();
  }
  return result;
}

Deformation deformation_of(const FitInput& input, const PlacedScan& start, const Subspace& subspace,
                           const FitOptions& options, const RunContext& context) {
  const FitState rest{start.pose, Eigen::VectorXd::Zero(subspace.degrees_of_freedom())};
  return deformation_from(rest, 0, input, start, subspace, options, context);
}

// The same shape with another scale as deformation: scaling keeps all groups, whose centres go along.
FitState at_scale(double scale, const FitState& state, const Subspace& subspace, const Mesh& mesh) {
  const Eigen::Vector3d centre = bounding_box_centre(mesh.vertices);
  FitState result;
  result.pose = {scale, state.pose.linear, state.pose(centre) - scale * (state.pose.linear * centre)};
  const Points& rest = subspace.sampling.points;
  const Points posed = rest + sample_displacements(subspace, state.q);
  Points target(rest.rows(), 3);
  const Similarity back = inverse(result.pose);
  for (Eigen::Index i = 0; i < rest.rows(); ++i) {
    target.row(i) = (back(state.pose(posed.row(i).transpose())) - rest.row(i).transpose()).transpose();
  }
  const Eigen::SparseMatrix<double>& columns = subspace.basis.columns;
  const Eigen::MatrixXd gram = columns.transpose() * columns;
  result.q = gram.ldlt().solve(columns.transpose() * stacked(target));
  return result;
}

// The template fitted without any group, finely enough that parts may move by themselves.
Mesh free_fit(const FitInput& input, const PlacedScan& start, const FitOptions& options, const RunContext& context) {
  constexpr int kSamples = 150;
  const SymmetryAnnotation none = empty_annotation(input.mesh, input.annotation.tolerance);
  FitOptions free = options;
  free.subspace = SubspaceOptions{};
  free.subspace.samples = kSamples;
  const FitInput without{input.mesh, none, input.scan, input.pose, input.landmarks, input.handles};
  const Subspace subspace = build_subspace(input.mesh, none, free.subspace, context);
  return deformation_of(without, start, subspace, free, context).fitted;
}

// Fills in what the deformation says.
void take(const FitInput& input, Deformation&& found, const PlacedScan& start, const Subspace& subspace,
          const FitOptions& options, const RunContext& context, FitResult& result) {
  result.pose = found.state.pose;
  result.q = found.state.q;
  result.samples = static_cast<int>(subspace.sampling.points.rows());
  result.degrees_of_freedom = subspace.degrees_of_freedom();
  result.iterations = std::move(found.iterations);
  result.stopped_because = std::move(found.stopped_because);
  result.condition = found.condition;
  result.used_fraction = start.used_fraction;
  result.rest_annotation = input.annotation;
  result.annotation =
      transformed(carried_annotation(input.annotation, subspace, result.q, found.deformed), result.pose);
  result.fitted = std::move(found.fitted);
  result.annotation.mesh_diagonal = diagonal(result.fitted.vertices);
  assess_fit(input, start.scan, options, context, result);
}

double worst_field_residual(const FitInput& input, const Subspace& subspace, const Eigen::VectorXd& q,
                            const RunContext& context) {
  double worst = 0;
  for (std::size_t i = 0; i < input.annotation.regions.size(); ++i) {
    const Region& region = input.annotation.regions[i];
    worst = std::max(worst, field_residual(subspace, input.mesh, region, static_cast<int>(i), q, context).max);
  }
  return worst;
}

// Compares the fit with one without groups, and where that is asked, fits anew without those that the scan has not.
void judge_groups(const FitInput& input, const PlacedScan& start, const FitOptions& options, const RunContext& context,
                  FitResult& result) {
  constexpr int kMostRelaxations = 5;
  const Mesh free = free_fit(input, start, options, context);
  for (int round = 0;; ++round) {
    std::vector<GroupAgreement> groups = group_agreement(result.fitted, free, result.annotation, start.scan, context);
    if (round == 0) result.groups = groups;
    std::erase_if(groups, [](const GroupAgreement& group) { return !group.disagrees; });
    if (!options.relax || groups.empty() || round == kMostRelaxations) return;
    for (const GroupAgreement& group : groups) {
      result.relaxed.push_back(group.region);
      context.message("left out region " + std::to_string(group.region) + ": the scan has not its symmetry");
    }
    const SymmetryAnnotation rest =
        closable(input.mesh, without_regions(result.rest_annotation, result.relaxed), context);
    const FitInput relaxed{input.mesh, rest, input.scan, input.pose, input.landmarks, input.handles};
    const Subspace subspace = build_subspace(input.mesh, rest, options.subspace, context);
    take(relaxed, deformation_of(relaxed, start, subspace, options, context), start, subspace, options, context,
         result);
    result.field_residual = worst_field_residual(relaxed, subspace, result.q, context);
  }
}

}  // namespace

FitResult fit(const FitInput& input, const FitOptions& options, const RunContext& context) {
  options.validate();
  FitResult result;
  Stopwatch watch(result.times);
  const std::vector<PlacedScan> starts = starts_of(input, options, context, result, watch);
  const Subspace subspace = build_subspace(input.mesh, input.annotation, options.subspace, context);
  watch.finished("subspace");
  PlacedScan start;
  FitResult best;
  int iterations = 0;
  const auto attempt = [&](const PlacedScan& from, Deformation&& found, double least_gain) {
    FitResult trial;
    take(input, std::move(found), from, subspace, options, context, trial);
    iterations += static_cast<int>(trial.iterations.size());
    const double better = trial.confidence * trial.used_fraction - best.confidence * best.used_fraction;
    if (iterations > static_cast<int>(trial.iterations.size()) && better <= least_gain) return;
    best = std::move(trial);
    start = from;
  };
  for (const PlacedScan& each : starts) {
    attempt(each, deformation_of(input, each, subspace, options, context), 0);
  }
  if (best.confidence < kWell && input.landmarks.empty() && input.handles.empty()) {
    const PlacedScan other = rescaled(input, start);
    const double growth = std::abs(std::log(other.pose.scale / start.pose.scale));
    if (growth > kOtherScale && growth < kSameKind) {
      Deformation found = deformation_of(input, other, subspace, options, context);
      // Back at the template's scale, so that what is not seen keeps the template's thickness.
      const FitState same_shape = at_scale(start.pose.scale, found.state, subspace, input.mesh);
      const double before = best.confidence * best.used_fraction;
      attempt(other, std::move(found), kWorthwhile);
      if (best.confidence * best.used_fraction > before) {
        const int level = 3 * options.levels / 4;
        attempt(other, deformation_from(same_shape, level, input, other, subspace, options, context), -kWorthwhile);
      }
    }
  }
  best.times = std::move(result.times);
  best.placements = std::move(result.placements);
  best.iterations_in_all = iterations;
  result = std::move(best);
  watch.finished("fit");
  result.field_residual = worst_field_residual(input, subspace, result.q, context);
  watch.finished("assessment");
  if ((options.judge_groups || options.relax) && !input.annotation.regions.empty()) {
    judge_groups(input, start, options, context, result);
    watch.finished("groups");
  }

  const double explained = result.inlier_fraction * result.used_fraction;
  const double seen = 1 - result.hidden_fraction;
  const bool explains =
      explained >= options.least_inliers && (result.placements.empty() || result.inlier_fraction >= kLeastOfPlaced);
  result.converged = !result.iterations.empty() && explains && seen >= kLeastSeen;
  if (result.iterations.empty() || result.converged) return result;
  const auto percent = [](double fraction) { return std::to_string(static_cast<int>(100 * fraction)) + " % of the "; };
  result.stopped_because +=
      explains ? "; only " + percent(seen) + "surface is seen" : "; only " + percent(explained) + "scan is explained";
  return result;
}

}  // namespace orbifit

#include "orbifit/fitting/fit.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

#include "orbifit/model/errors.h"
#include "orbifit/subspace/displacement_field.h"

#include "assessment/fit_assessment.h"
#include "assessment/group_comparison.h"
#include "assessment/open_poses.h"
#include "assessment/open_stretches.h"
#include "fit_loop.h"
#include "fit_systems.h"
#include "fit_trial.h"
#include "refinement.h"
#include "registration/correspondences.h"
#include "relaxation.h"
#include "scan/thinned_scan.h"
#include "side_by_side.h"
#include "solver/fit_system.h"
#include "stage_clock.h"
#include "start/fit_starts.h"
#include "start/joined_scans.h"
#include "start/other_scale.h"
#include "start/placed_scan.h"
#include "start/thinned_input.h"

namespace orbifit {

namespace {

constexpr double kMinSeen = 0.04;      // of the fitted surface: an edge lies along any line
constexpr double kSofter = 0.75;       // of the levels: where fits of a shape that is known begin
constexpr double kWell = 0.995;        // confidence from which another scale is not tried
constexpr double kWorthwhile = 0.005;  // what another scale, or a place that suits the template less, must explain more

}  // namespace

void FitOptions::validate() const {
  subspace.validate();
  placement.validate();
  require(levels >= 1, "levels", levels, "at least 1");
  require(iterations >= 1, "iterations", iterations, "at least 1");
  require(max_iterations >= levels * iterations, "max_iterations", max_iterations,
          "at least levels * iterations = " + std::to_string(levels * iterations));
  require(last_stiffness > 0, "last_stiffness", last_stiffness, "positive");
  require(first_stiffness > last_stiffness, "first_stiffness", first_stiffness, "more than last_stiffness");
  require(least_stiffness >= 0, "least_stiffness", least_stiffness, "0 or more");
  require(stretch >= 0, "stretch", stretch, "0 or more");
  require(tie > 0 && tie <= 1, "tie", tie, "in (0, 1]");
  require(max_tied >= 1, "max_tied", max_tied, "at least 1");
  require(max_tried >= max_tied, "max_tried", max_tried, "at least max_tied");
  require(trim > 0 && trim <= 1, "trim", trim, "in (0, 1]");
  require(scan_points >= 10, "scan_points", scan_points, "at least 10");
  require(refinements >= 0, "refinements", refinements, "0 or more");
#ifdef ORBIFIT_PORTABLE
  require(!detail, "detail", 1, "false: there is none in the editor's core");
#endif
  require(landmark_weight > 0, "landmark_weight", landmark_weight, "positive");
  require(inlier_distance > 0, "inlier_distance", inlier_distance, "positive");
  require(min_inlier_ratio >= 0 && min_inlier_ratio <= 1, "min_inlier_ratio", min_inlier_ratio, "in [0, 1]");
}

namespace {

// What fits of one template are compared by: of two, the one that lies where the scan has nothing is the worse.
double worth(const FitResult& result) {
  return result.confidence * (1 - result.cut_off) * result.overlap;
}

// The best fit so far, and where it started.
struct Best {
  FitResult result;
  PlacedScan start;
};

// Fits from another scale, where that explains more. It ends at the scale of the start, so that what is not seen keeps
// the template's thickness, unless that explains less by more than it had to explain more, and the size is open.
void try_other_scale(const FitInput& input, FitSystem& system, const FitOptions& options, const RunContext& context,
                     Best& best) {
  const std::optional<PlacedScan> other = at_other_scale(input, best.start, context);
  if (!other) return;
  FitResult grown = fit_from(input, *other, system, options, context);
  const int before = best.result.iterations_in_all;
  best.result.iterations_in_all += grown.iterations_in_all;
  if (worth(grown) <= worth(best.result) + kWorthwhile) return;
  FitState back = with_scale(best.start.pose.scale, grown.pose, {grown.q, grown.basis}, system.subspace(), input.mesh);
  const int level = static_cast<int>(kSofter * options.levels);
  back.others = grown.others;
  FitResult shrunk = fit_from(std::move(back), level, input, *other, system, options, context);
  const int in_all = before + grown.iterations_in_all + shrunk.iterations_in_all;
  if (options.fixed_scale) {
    if (worth(shrunk) > worth(best.result) + kWorthwhile) best.result = std::move(shrunk);
    best.result.iterations_in_all = in_all;
    return;
  }
  best.start = *other;
  best.result = worth(shrunk) > worth(grown) - kWorthwhile ? std::move(shrunk) : std::move(grown);
  best.result.iterations_in_all = in_all;
}

// Keeps the starts of which a short fit, which shows what deformation makes of them, promises most.
// \return the iterations it took
int keep_promising(std::vector<PlacedScan>& starts, const FitInput& input, FitSystems& systems,
                   const FitOptions& options, const RunContext& context) {
  constexpr int kSettling = 3;  // iterations
  if (static_cast<int>(starts.size()) <= options.max_tied) return 0;
  FitOptions brief = options;
  brief.levels = std::min(options.levels, 5);
  brief.iterations = 1;
  brief.max_iterations = brief.levels + kSettling;
  brief.condition = false;
  std::vector<std::pair<double, std::size_t>> promises(starts.size());
  std::vector<int> taken(starts.size());
  systems.share(starts.size(), context, [&](std::size_t i, FitSystem& system, const RunContext& own) {
    const FitResult found = fit_from(input, starts[i], system, brief, own);
    taken[i] = found.iterations_in_all;
    promises[i] = {-worth(found), i};
  });
  const int iterations = std::accumulate(taken.begin(), taken.end(), 0);
  std::ranges::sort(promises);
  promises.resize(static_cast<std::size_t>(options.max_tied));
  std::vector<PlacedScan> kept;
  kept.reserve(promises.size());
  for (const auto& [promise, i] : promises) kept.push_back(std::move(starts[i]));
  starts = std::move(kept);
  return iterations;
}

Best best_of(std::vector<PlacedScan> starts, const FitInput& input, const Subspace& subspace, const FitOptions& options,
             const RunContext& context) {
  FitSystems systems(subspace, input.mesh, options.stretch,
                     contacts_to_keep(starts.front(), subspace, input.mesh, options, context));
  int iterations = keep_promising(starts, input, systems, options, context);
  std::vector<FitResult> results(starts.size());
  systems.share(starts.size(), context, [&](std::size_t i, FitSystem& system, const RunContext& own) {
    results[i] = fit_from(input, starts[i], system, options, own);
  });
  std::optional<Best> best;
  for (std::size_t i = 0; i < starts.size(); ++i) {
    iterations += results[i].iterations_in_all;
    if (!best || worth(results[i]) > worth(best->result) + kWorthwhile) {
      best = Best{std::move(results[i]), std::move(starts[i])};
    }
  }
  best->result.iterations_in_all = iterations;
  if (best->result.confidence * (1 - best->result.cut_off) < kWell) {
    systems.share(1, context, [&](std::size_t, FitSystem& system, const RunContext& own) {
      try_other_scale(input, system, options, own, *best);
    });
  }
  return std::move(*best);
}

// Whether the fit is one, and why not.
void conclude(const FitOptions& options, FitResult& result) {
  const double seen = 1 - result.hidden_fraction;
  const bool explains = explains_scan(result, !result.placements.empty(), options);
  result.converged = !result.iterations.empty() && explains && seen >= kMinSeen;
  if (result.iterations.empty() || result.converged) return;
  const auto percent = [](double fraction) { return std::to_string(static_cast<int>(100 * fraction)) + " % of the "; };
  result.stopped_because += explains ? "; only " + percent(seen) + "surface is seen"
                                     : "; only " + percent(explained_share(result)) + "scan is explained";
}

}  // namespace

namespace {

// A fit before it is judged, and what it came from.
struct Trial {
  FitInput input;  // with the landmarks that agree with where it started
  Best best;
};

FitInput with_landmarks(const FitInput& input, const std::vector<char>& chosen) {
  FitInput result = input;
  result.landmarks.clear();
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    if (chosen[i] != 0) result.landmarks.push_back(input.landmarks[i]);
  }
  return result;
}

// With the other scans, once the first one has told the shape well enough to find them by it: from the template's rest
// shape and from that shape, whichever explains more.
void fit_all_scans(const FitInput& input, const FitOptions& options, const RunContext& context, Best& best) {
  if (input.others.empty()) return;
  const FitResult first = std::move(best.result);
  best.start = join_scans(input, best.start, first, options, context);
  FitSystem system(*input.subspace, input.mesh, options.stretch,
                   contacts_to_keep(best.start, *input.subspace, input.mesh, options, context));
  best.result = fit_from(input, best.start, system, options, context);
  FitState state = with_scale(best.start.pose.scale, first.pose, {first.q, first.basis}, *input.subspace, input.mesh);
  FitResult further = fit_from(std::move(state), static_cast<int>(kSofter * options.levels), input, best.start, system,
                               options, context);
  const int in_all = first.iterations_in_all + best.result.iterations_in_all + further.iterations_in_all;
  if (worth(further) > worth(best.result) + kWorthwhile) best.result = std::move(further);
  best.result.iterations_in_all = in_all;
  if (best.result.confidence < kWell) try_other_scale(input, system, options, context, best);
  for (std::size_t k = 0; k < best.start.others.size(); ++k) {
    best.result.others[k] = best.result.others[k] * best.start.others[k];
  }
  best.result.other_used = best.start.other_used;
}

Trial trial_of(const FitInput& input, const FitOptions& options, bool doubt_landmarks, const RunContext& context,
               StageClock& clock) {
  FitStarts starts;
  std::shared_ptr<const Subspace> subspace = input.subspace;
  std::vector<StageTime> finding;
  std::vector<SideTask> tasks;
  double building = 0;
  if (!subspace) {
    tasks.emplace_back([&](const RunContext& own) {
      const Stopwatch stopwatch;
      subspace = std::make_shared<Subspace>(build_subspace(input.mesh, input.annotation, options.subspace, own));
      building = stopwatch.seconds();
    });
  }
  tasks.emplace_back([&](const RunContext& own) {
    StageClock own_clock(finding);
    starts = find_starts(input, options, doubt_landmarks, own, own_clock);
  });
  side_by_side(tasks, context);
  if (!input.subspace) clock.took("subspace", building);
  for (std::size_t i = 0; i + 1 < finding.size(); ++i) clock.took(finding[i].stage, finding[i].seconds);
  clock.finished(finding.back().stage);
  FitInput agreed = with_landmarks(input, starts.agrees);
  agreed.subspace = std::move(subspace);
  Best best = best_of(std::move(starts.places), agreed, *agreed.subspace, options, context);
  fit_all_scans(agreed, options, context, best);
  best.result.placements = std::move(starts.placements);
  clock.finished("fit");
  return {std::move(agreed), std::move(best)};
}

// Landmarks that agree with one another may all be wrong, or be too few to tell. Where a fit from their pose explains
// too little of the scan, one from where the scan has the template, which explains more, is better.
Trial better_in_doubt(const FitInput& input, const FitOptions& options, const RunContext& context, StageClock& clock,
                      Trial trial) {
  const FitResult& told = trial.best.result;
  const bool found = !told.placements.empty();
  if (!options.place || found || input.landmarks.empty() || !input.handles.empty()) return trial;
  if (explains_scan(told, true, options)) return trial;
  FitInput again = input;
  again.subspace = trial.input.subspace;
  Trial other = trial_of(again, options, true, context, clock);
  return worth(other.best.result) > worth(told) + kWorthwhile ? std::move(other) : std::move(trial);
}

// Refines a fit that is one: a subspace that is fine enough explains any scan, so that whether this one is the
// template's a coarse one tells. Likewise whether its groups are the scan's, where the refined fit leaves that in
// doubt; unless those that are unsupported were dropped.
void refine_and_judge(const Trial& trial, const FitOptions& options, const RunContext& context, StageClock& clock,
                      FitResult& result) {
  const bool judges = options.judge_groups && !options.drop_unsupported && !trial.input.annotation.regions.empty();
  const SymmetryAnnotation rest = result.rest_annotation;
  Mesh coarse;
  SymmetryAnnotation carried;
  if (judges) {
    coarse = result.fitted;
    carried = result.annotation;
  }
  if (result.converged) {
    refine(trial.input.with(rest), trial.best.start, options, context, result);
    conclude(options, result);
    clock.finished("refinement");
  }
  if (!judges) return;
  auto told = agreement_beyond_doubt(result.fitted, result.annotation, trial.best.start.scan, context);
  result.groups =
      told ? *std::move(told) : judged_groups(coarse, carried, trial.input, trial.best.start, options, context);
  clock.finished("groups");
}

// What the scan leaves open, of size and pose, is the template's then, or chance's: the fit is the less to be relied
// on.
void tell_what_is_open(const PlacedScan& start, const FitOptions& options, const RunContext& context,
                       FitResult& result) {
  if (!result.converged) return;
  std::vector<Motion> moves;  // beyond those by which the start's scan is one
  for (std::size_t k = 0; k < result.others.size(); ++k) moves.push_back(result.others[k] * inverse(start.others[k]));
  const PreparedScan scan = with_others_moved(start, moves);
  const SeenSurface& seen = start.views->silhouette.seen();
  result.open_stretches = open_stretches(scan, seen, options, context, result);
  result.open_poses = open_poses(scan, seen, options, context, result);
  result.confidence *= (1 - result.open_stretch()) * (1 - std::min(1.0, result.open_distance()));
}

// How near the fit has brought the vertices to the targets. What it says of a landmark in the end counts, not whether
// it agreed with the template as it is: the shape may differ there. Those that are far have not counted, and are named.
void tell_landmarks(const FitInput& input, const RunContext& context, FitResult& result) {
  const double size = diagonal(result.fitted.vertices);
  for (std::size_t i = 0; i < input.landmarks.size(); ++i) {
    const Landmark& landmark = input.landmarks[i];
    const double off = (result.fitted.vertices.row(landmark.vertex).transpose() - landmark.target).norm() / size;
    result.landmarks.push_back({landmark.vertex, off, off > kLastReach});
    if (off <= kLastReach) continue;
    context.message("left out landmarks[" + std::to_string(i) + "]: its target is " +
                    std::to_string(std::lround(100 * off)) + " % of the diagonal away from where vertex " +
                    std::to_string(landmark.vertex) + " lies by the other landmarks and the scan");
  }
}

}  // namespace

FitResult fit(const FitInput& given, const FitOptions& options, const RunContext& context) {
  options.validate();
  std::vector<StageTime> times;
  StageClock clock(times);
  const ThinnedInput read(given, std::max(kScanPointsRead, options.scan_points), context.seed);
  const FitInput& input = read.input();
  Trial first = trial_of(input, options, false, context, clock);
  Trial trial = better_in_doubt(input, options, context, clock, std::move(first));
  FitResult result = std::move(trial.best.result);
  if (options.drop_unsupported && !input.annotation.regions.empty()) {
    drop_unsupported(trial.input, trial.best.start, options, context, result);
    clock.finished("groups");
  }
  conclude(options, result);
  refine_and_judge(trial, options, context, clock, result);
  tell_what_is_open(trial.best.start, options, context, result);
  tell_landmarks(input, context, result);
  result.field_residual =
      worst_field_residual(result.subspace, input.mesh, result.rest_annotation, result.state(), context);
  clock.finished("assessment");
  result.times = std::move(times);
  return result;
}

}  // namespace orbifit

#include "start/fit_starts.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/LU>

#include "placement/surface_placements.h"
#include "quiet_context.h"
#include "registration/alignment.h"
#include "registration/landmark_consensus.h"
#include "scan/scan_preparation.h"
#include "solver/pulls.h"

namespace orbifit {

namespace {

constexpr double kSameShape = 0.001;  // of the diagonal: landmarks that agree so well are of a shape that is the same

// Rotations that bring the whole template onto itself: poses that differ by one of them are one to the scan, but not
// to a landmark. The identity among them.
std::vector<Motion> rotations_of(const SymmetryAnnotation& annotation, const Mesh& mesh) {
  std::vector<Motion> result{Motion{}};
  for (const Region& region : annotation.regions) {
    if (static_cast<Eigen::Index>(region.faces.size()) != mesh.faces.rows()) continue;
    std::ranges::copy_if(region.elements, std::back_inserter(result),
                         [](const Motion& element) { return element.linear.determinant() > 0; });
  }
  return result;
}

// Puts each placement the way round in which landmarks lie nearest to their targets, robustly; and where there are
// placements at which all of them are near, keeps those alone.
void choose_by_landmarks(const FitInput& input, std::vector<Placement>& found) {
  if (input.landmarks.empty()) return;
  const std::vector<Motion> rotations = rotations_of(input.annotation, input.mesh);
  std::vector<Placement> chosen;
  for (Placement& placement : found) {
    const Similarity pose = placement.pose;
    double least = std::numeric_limits<double>::infinity();
    for (const Motion& rotation : rotations) {
      const Similarity turned = pose * Similarity{1, rotation.linear, rotation.translation};
      const double sum = landmark_sum(input.mesh, input.landmarks, turned, kNearTemplate);
      if (sum >= least) continue;
      least = sum;
      placement.pose = turned;
    }
    const std::vector<char> near = near_targets(input.mesh, input.landmarks, placement.pose, kNearTemplate);
    if (std::ranges::count(near, 0) == 0) chosen.push_back(placement);
  }
  if (!chosen.empty()) found = std::move(chosen);
}

FitStarts found_starts(const FitInput& input, const MatchSurface& surface, const LandmarkConsensus& said,
                       const FitOptions& options, const ScanPreparationOptions& preparation,
                       const RunContext& context) {
  FitStarts result;
  PlacementOptions placement = options.placement;
  if (options.fixed_scale) placement.scale = input.pose.scale;
  const Similarity given = input.landmarks.empty() ? input.pose : said.pose;
  std::vector<Placement> found = find_placements(surface, input.annotation, input.scan, placement, context, given);
  choose_by_landmarks(input, found);
  // Side by side; others in place of those that have too little of the scan near them.
  std::size_t tied = 0;
  while (tied < found.size() && found[tied].score() >= options.tie * found.front().score()) ++tied;
  const auto most = static_cast<std::size_t>(options.max_tried);
  for (std::size_t first = 0; first < tied && result.places.size() < most;) {
    const std::size_t count = std::min(most - result.places.size(), tied - first);
    std::vector<std::optional<PlacedScan>> placed(count);
    const RunContext own = quiet_context(context, count);
    parallel_for(context, count, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        placed[i] = found_scan(surface, input.scan, found[first + i].pose, given, options.placement, preparation, own);
      }
    });
    for (auto& each : placed) {
      if (!each) continue;
      each->scale_open = each->scale_open && !options.fixed_scale;
      result.places.push_back(std::move(*each));
    }
    first += count;
  }
  if (!result.places.empty()) result.placements = std::move(found);
  return result;
}

// How far places of the template are said to be from where its rest shape has them, fraction of the diagonal.
double slack_of(const FitInput& input, const LandmarkConsensus& said, const Similarity& pose) {
  FitInput handled = input;
  handled.landmarks.clear();
  double squared = 0;
  for (const Pull& pull : pulls_towards(handled, pose, 1)) {
    squared = std::max(squared, (input.mesh.vertices.row(pull.vertex).transpose() - pull.target).squaredNorm());
  }
  return std::max(said.largest_residual, std::sqrt(squared) / diagonal(input.mesh.vertices));
}

// The pose with scale in which the template as it is explains most of the scan near the given one: from there it is
// told what is the template's, whose lengths may be others. The given one where that is another place.
Similarity best_explaining(const MatchSurface& surface, const PreparedScan& scan, const Similarity& given,
                           const RunContext& context) {
  constexpr int kEnough = 1500;
  const auto count = static_cast<int>(scan.points.rows());
  std::vector<int> some;
  for (int i = 0; i < count; i += std::max(1, count / kEnough)) some.push_back(i);
  const Similarity found = align_with_scale(surface, scan, some, given, {}, context);
  return near_given(surface.mesh(), found, given) ? found : given;
}

PlacedScan given_start(const FitInput& input, const MatchSurface& surface, const LandmarkConsensus& said,
                       const FitOptions& options, const ScanPreparationOptions& preparation,
                       const RunContext& context) {
  const bool refined = options.align && input.landmarks.empty() && input.handles.empty();
  Similarity pose = input.landmarks.empty() ? input.pose : said.pose;
  PlacedScan whole;
  whole.scan = prepare_scan(input.scan, preparation, context);
  if (refined) pose = align_rigidly(surface, whole.scan, pose, context);
  whole.pose = pose;
  const Similarity best = best_explaining(surface, whole.scan, pose, context);
  std::optional<PlacedScan> placed =
      placed_scan(surface, input.scan, best, slack_of(input, said, best), options.placement, preparation, context);
  if (!placed) return whole;
  placed->pose = pose;
  // Landmarks of another shape tell its size no better than they fit it.
  placed->scale_open = !options.fixed_scale && !input.landmarks.empty() && said.largest_residual > kSameShape &&
                       !near_given(surface.mesh(), pose, input.pose);
  // Other things may have drawn it aside.
  if (refined && placed->overlap < 1) placed->pose = align_rigidly(surface, placed->scan, pose, context);
  return std::move(*placed);
}

// A pose that is neither sought nor refined is known: landmarks then say where their places are, and nothing else.
LandmarkConsensus said_by_landmarks(const FitInput& input, const FitOptions& options) {
  if (options.place || options.align) {
    return landmark_consensus(input.mesh, input.landmarks, kNearTemplate,
                              options.fixed_scale ? std::optional(input.pose.scale) : std::nullopt);
  }
  LandmarkConsensus said{input.pose, true, near_targets(input.mesh, input.landmarks, input.pose, kNearTemplate), 0};
  for (std::size_t i = 0; i < said.agrees.size(); ++i) {
    if (said.agrees[i] == 0) continue;
    said.largest_residual =
        std::max(said.largest_residual, landmark_residual(input.mesh, input.landmarks[i], input.pose));
  }
  return said;
}

FitStarts starts_of(const FitInput& input, const FitOptions& options, bool doubt_landmarks, const RunContext& context,
                    StageClock& clock) {
  ScanPreparationOptions preparation;
  preparation.most_points = options.scan_points;
  const auto shared = std::make_shared<const SharedTemplate>(input.mesh, options.contacts, input.subspace,
                                                             input.surface_index, context);
  const MatchSurface& surface = shared->surface();
  LandmarkConsensus said = said_by_landmarks(input, options);
  if (doubt_landmarks) said.pose = input.pose;
  FitStarts result;
  if (options.place && (doubt_landmarks || !said.determined) && input.handles.empty()) {
    result = found_starts(input, surface, said, options, preparation, context);
    if (!result.places.empty()) {
      result.agrees = near_targets(input.mesh, input.landmarks, result.places.front().pose, kNearTemplate);
    }
    clock.finished("placement");
  }
  if (result.places.empty()) {
    result.places.push_back(given_start(input, surface, said, options, preparation, context));
    result.agrees = said.agrees;
    clock.finished("scan");
  }
  for (PlacedScan& start : result.places) start.shared = shared;
  return result;
}

}  // namespace

FitStarts find_starts(const FitInput& input, const FitOptions& options, bool doubt_landmarks, const RunContext& context,
                      StageClock& clock) {
  FitStarts result = starts_of(input, options, doubt_landmarks, context, clock);
  const RunContext own = quiet_context(context, result.places.size());
  parallel_for(context, result.places.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      PlacedScan& start = result.places[i];
      start.views = std::make_shared<const ScanViews>(input.mesh, start.shared->tree(), input.scan, start.scan, own);
    }
  });
  return result;
}

}  // namespace orbifit

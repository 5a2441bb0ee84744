#include "fit_starts.h"

#include <utility>

#include "orbifit/fitting/alignment.h"
#include "orbifit/fitting/scan_preparation.h"

namespace orbifit {

namespace {

FitStarts found_starts(const FitInput& input, const FitOptions& options, const ScanPreparationOptions& preparation,
                       const RunContext& context) {
  FitStarts result;
  const MatchSurface surface(input.mesh);
  std::vector<Placement> found =
      find_placements(surface, input.annotation, input.scan, options.placement, context, input.pose);
  for (const Placement& each : found) {
    if (static_cast<int>(result.places.size()) == options.most_tried) break;
    if (each.score() < options.tie * found.front().score()) break;
    auto placed = placed_scan(surface, input.scan, each.pose, input.pose, options.placement, preparation, context);
    if (placed) result.places.push_back(std::move(*placed));
  }
  if (!result.places.empty()) result.placements = std::move(found);
  return result;
}

FitStarts starts_of(const FitInput& input, const FitOptions& options, const RunContext& context, StageClock& clock) {
  ScanPreparationOptions preparation;
  preparation.most_points = options.scan_points;
  FitStarts result;
  const bool given = !input.landmarks.empty() || !input.handles.empty();
  if (options.place && !given) {
    result = found_starts(input, options, preparation, context);
    clock.finished("placement");
    if (!result.places.empty()) return result;
  }
  PlacedScan start;
  start.scan = prepare_scan(input.scan, preparation, context);
  start.pose = input.pose;
  clock.finished("scan");
  if (!input.landmarks.empty()) {
    start.pose = align_landmarks(input.mesh, input.landmarks);
  } else if (options.align && !given) {
    start.pose = align_rigidly(MatchSurface(input.mesh), start.scan, input.pose, context);
  }
  clock.finished("alignment");
  result.places.push_back(std::move(start));
  return result;
}

}  // namespace

FitStarts find_starts(const FitInput& input, const FitOptions& options, const RunContext& context, StageClock& clock) {
  FitStarts result = starts_of(input, options, context, clock);
  for (PlacedScan& start : result.places) {
    start.views = std::make_shared<const ScanViews>(input.mesh, input.scan, start.scan, context);
  }
  return result;
}

}  // namespace orbifit

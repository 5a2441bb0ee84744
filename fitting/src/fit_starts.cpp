#include "fit_starts.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "placement/surface_placements.h"
#include "quiet_context.h"
#include "registration/alignment.h"
#include "scan/scan_preparation.h"

namespace orbifit {

namespace {

FitStarts found_starts(const FitInput& input, const FitOptions& options, const ScanPreparationOptions& preparation,
                       const RunContext& context) {
  FitStarts result;
  const MatchSurface surface(input.mesh);
  std::vector<Placement> found =
      find_placements(surface, input.annotation, input.scan, options.placement, context, input.pose);
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
        placed[i] =
            placed_scan(surface, input.scan, found[first + i].pose, input.pose, options.placement, preparation, own);
      }
    });
    for (auto& each : placed) {
      if (each) result.places.push_back(std::move(*each));
    }
    first += count;
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
  const RunContext own = quiet_context(context, result.places.size());
  parallel_for(context, result.places.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      PlacedScan& start = result.places[i];
      start.views = std::make_shared<const ScanViews>(input.mesh, input.scan, start.scan, own);
    }
  });
  return result;
}

}  // namespace orbifit

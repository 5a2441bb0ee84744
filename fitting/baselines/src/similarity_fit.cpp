#include "orbifit/baselines/similarity_fit.h"

#include <numeric>

#include "orbifit/model/errors.h"

#include "baseline_fit.h"
#include "registration/alignment.h"

namespace orbifit {

namespace {

std::vector<Landmark> landmarks_of(const FitInput& input) {
  std::vector<Landmark> result;
  for (const Handle& handle : input.handles) {
    for (const int vertex : handle.vertices) {
      result.push_back({vertex, input.pose(handle.motion(input.mesh.vertices.row(vertex).transpose()))});
    }
  }
  return result;
}

}  // namespace

void SimilarityOptions::validate() const {
  fit.validate();
  require(iterations >= 1, "iterations", iterations, "at least 1");
}

FitResult fit_similarity(const FitInput& input, const SimilarityOptions& options, const RunContext& context) {
  options.validate();
  FitResult result;
  StageClock clock(result.times);
  PlacedScan start;
  const bool edit = by_handles_alone(input);
  if (!edit) start = baseline_start(input, options.fit, context);
  clock.finished("prepare");
  result.pose = edit ? align_landmarks(input.mesh, landmarks_of(input)) : start.pose;
  if (!edit) {
    ScaledAlignmentOptions scaled;
    scaled.iterations = options.iterations;
    std::vector<int> points(static_cast<std::size_t>(start.scan.points.rows()));
    std::iota(points.begin(), points.end(), 0);
    result.pose = align_with_scale(MatchSurface(input.mesh), start.scan, points, start.pose, scaled, context);
    result.stopped_because = "the iterations asked for are done";
  }
  clock.finished("fit");
  result.degrees_of_freedom = 7;
  finish_baseline(input, options.fit, Points::Zero(input.mesh.vertices.rows(), 3), edit ? nullptr : &start, context,
                  result);
  carry_annotation(input, nullptr, {}, result);
  return result;
}

}  // namespace orbifit

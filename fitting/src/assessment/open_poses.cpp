#include "assessment/open_poses.h"

#include <algorithm>
#include <vector>

#include "assessment/fit_evidence.h"
#include "registration/alignment.h"

namespace orbifit {

namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;

struct PosePolicy {
  double apart = 0.03;  // of the diagonal: poses that differ less are one
  int looks = 1500;     // of the surface: a handle of a fiftieth of its area has thirty
};
constexpr PosePolicy kPosePolicy;

// Where a motion takes the surface farthest from where it was.
OpenPose farthest(const FitEvidence& probe, const Motion& move) {
  OpenPose result{move};
  const Index step = std::max<Index>(1, probe.samples().rows() / kPosePolicy.looks);
  for (Index i = 0; i < probe.samples().rows(); i += step) {
    const Vector3d there = move(probe.samples().row(i).transpose());
    const double distance = probe.surface().index.nearest(there).distance / probe.size();
    if (distance > result.apart) result = {move, distance, there};
  }
  return result;
}

// A placement as a motion of the fitted surface: at its size, the scan's middle staying where it is on the template.
Similarity moved_to(const Similarity& placement, const FitResult& result, const Vector3d& middle) {
  const double growth = result.pose.scale / placement.scale;
  const Similarity about{growth, Matrix3d::Identity(), middle - growth * middle};
  return about * placement * inverse(result.pose);
}

// With the error that it leaves; none where `apart` is 0.
struct Found {
  OpenPose pose;
  double error = 0;
};

}  // namespace

std::vector<OpenPose> open_poses(const PreparedScan& scan, const SeenSurface& seen, const FitOptions& options,
                                 const RunContext& context, const FitResult& result) {
  if (result.placements.empty()) return {};
  const FitEvidence probe(scan, seen, options, context, result.fitted, FitEvidence::Asked::all);
  const Evidence own = probe.of(Matrix3d::Identity(), 0);
  const Vector3d middle = scan.points.colwise().mean().transpose();
  ScaledAlignmentOptions alignment;
  alignment.keep_scale = true;
  RunContext alone = context;
  alone.threads = 1;
  std::vector<Found> tried(result.placements.size());
  parallel_for(context, tried.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Similarity start = moved_to(result.placements[i].pose, result, middle);
      const Similarity near = align_with_scale(probe.surface(), scan, probe.points(), start, alignment, alone);
      const Evidence evidence = probe.of(Matrix3d::Identity(), 0, inverse(near));
      if (!own.as_good(evidence)) continue;
      const Similarity move = inverse(evidence.move);
      const OpenPose pose = farthest(probe, {move.linear, move.translation});
      tried[i] = {pose, evidence.error};
    }
  });
  std::erase_if(tried, [](const Found& each) { return each.pose.apart < kPosePolicy.apart; });
  std::ranges::stable_sort(tried, {}, &Found::error);
  std::vector<OpenPose> found;
  for (const Found& each : tried) {
    const bool known = std::ranges::any_of(found, [&](const OpenPose& other) {
      return farthest(probe, inverse(other.move) * each.pose.move).apart < kPosePolicy.apart;
    });
    if (!known) found.push_back(each.pose);
  }
  return found;
}

}  // namespace orbifit

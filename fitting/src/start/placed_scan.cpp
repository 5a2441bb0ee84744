#include "start/placed_scan.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/random.h"
#include "geometry/point_index.h"
#include "geometry/surface_index.h"
#include "registration/alignment.h"
#include "scan/clutter.h"

namespace orbifit {

namespace {

struct Shares {
  double used = 0;  // of the scan's points, that stand where points were kept; planes that were taken out leave none
  double torn_off = 0;  // far from the template, and yet joined to those by others like them
};

// \param reach  of the template's points, scan units: farther ones were left out for that
Shares shares_of(const PointCloud& cloud, const PreparedScan& kept, const SurfaceIndex& surface, const Similarity& pose,
                 double reach, const RunContext& context) {
  constexpr Eigen::Index kMaxLooks = 4000;
  constexpr double kJoined = 3;  // spacings
  Random random(context.seed, "share of a scan");
  const auto count = static_cast<std::size_t>(std::min(kMaxLooks, cloud.points.rows()));
  Points looks = cloud.points.topRows(static_cast<Eigen::Index>(count));
  if (cloud.points.rows() > kMaxLooks) {
    for (auto look : looks.rowwise()) {
      const auto row = random.below(static_cast<std::uint64_t>(cloud.points.rows()));
      look = cloud.points.row(static_cast<Eigen::Index>(row));
    }
  }
  const PointIndex index(kept.points);
  const Similarity back = inverse(pose);
  std::vector<char> may_join(count, 0);
  std::vector<int> front;
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d point = looks.row(static_cast<Eigen::Index>(i));
    if (index.any_within(point, 2 * kept.spacing)) {
      front.push_back(static_cast<int>(i));
    } else if (surface.nearest(back(point), reach / pose.scale).face < 0) {
      may_join[i] = 1;
    }
  }
  Shares result;
  result.used = static_cast<double>(front.size()) / static_cast<double>(count);
  const PointIndex others(looks);
  const double joined = kJoined * median_spacing(looks);
  while (!front.empty()) {
    const int i = front.back();
    front.pop_back();
    for (const auto& neighbour : others.within(looks.row(i).transpose(), joined)) {
      char& open = may_join[static_cast<std::size_t>(neighbour.index)];
      if (open == 0) continue;
      open = 0;
      result.torn_off += 1.0 / static_cast<double>(count);
      front.push_back(neighbour.index);
    }
  }
  return result;
}

}  // namespace

bool near_given(const Mesh& mesh, const Similarity& found, const Similarity& given) {
  constexpr double kTurn = 0.3;     // radians
  constexpr double kOffset = 0.15;  // of the diagonal
  constexpr double kScale = 0.35;   // of its logarithm
  const Eigen::Vector3d centre = bounding_box_centre(mesh.vertices);
  return std::abs(std::log(found.scale / given.scale)) < kScale &&
         axis_angle(found.linear * given.linear.transpose()).angle < kTurn &&
         (found(centre) - given(centre)).norm() < kOffset * given.scale * diagonal(mesh.vertices);
}

PreparedScan with_others_moved(const PlacedScan& start, const std::vector<Motion>& moves) {
  PreparedScan result = start.scan;
  if (moves.empty()) return result;
  for (std::size_t i = 0; i < start.view_of.size(); ++i) {
    const int view = start.view_of[i];
    if (view == 0) continue;
    const Motion& move = moves[static_cast<std::size_t>(view - 1)];
    const auto row = static_cast<Eigen::Index>(i);
    result.points.row(row) = move(result.points.row(row).transpose()).transpose();
    result.normals.row(row) = (move.linear * result.normals.row(row).transpose()).transpose();
    if (result.viewpoints.rows() == result.points.rows()) {
      result.viewpoints.row(row) = move(result.viewpoints.row(row).transpose()).transpose();
    }
  }
  return result;
}

MovingSurface moving_template(const PlacedScan& start, const Mesh& mesh) {
  return start.shared ? start.shared->tree() : MovingSurface(mesh);
}

std::optional<PlacedScan> placed_scan(const MatchSurface& surface, const PointCloud& cloud, const Similarity& pose,
                                      double slack, const PlacementOptions& options,
                                      const ScanPreparationOptions& preparation, const RunContext& context) {
  constexpr int kMore = 2;  // points, where planes among them go
  constexpr Eigen::Index kMinNear = 10;
  const double size = diagonal(surface.mesh().vertices);
  const double reach = kNearTemplate + slack;
  const PointCloud near = points_near(surface.index, size, cloud, pose, reach, context);
  if (near.points.rows() < kMinNear || !(diagonal(near.points) > 0)) return std::nullopt;
  const auto rid_of_planes = [&](const PreparedScan& scan) {
    return without_planes(surface.index, size, scan, pose, options.reach, context);
  };
  PreparedScan prepared = prepare_scan(near, preparation, context);
  PlacedScan result;
  result.scan = rid_of_planes(prepared);
  if (result.scan.points.rows() < prepared.points.rows()) {
    ScanPreparationOptions more = preparation;
    more.most_points *= kMore;
    result.scan = rid_of_planes(prepare_scan(near, more, context));
  }
  if (result.scan.points.rows() < kMinNear) return std::nullopt;
  const Shares shares = shares_of(cloud, result.scan, surface.index, pose, reach * size * pose.scale, context);
  result.overlap = shares.used;
  result.torn_off = shares.torn_off;
  result.pose = pose;
  return result;
}

std::optional<PlacedScan> found_scan(const MatchSurface& surface, const PointCloud& cloud, const Similarity& pose,
                                     const Similarity& given, const PlacementOptions& options,
                                     const ScanPreparationOptions& preparation, const RunContext& context) {
  std::optional<PlacedScan> result = placed_scan(surface, cloud, pose, 0, options, preparation, context);
  if (!result) return result;
  result->scale_open = !near_given(surface.mesh(), pose, given);
  if (!result->scale_open) result->pose = align_rigidly(surface, result->scan, given, context);
  return result;
}

}  // namespace orbifit

#include "start/joined_scans.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>

#include "orbifit/fitting/placement.h"

#include "placement/surface_placements.h"
#include "registration/alignment.h"

namespace orbifit {

namespace {

Points stacked_rows(const Points& upper, const Points& lower) {
  Points result(upper.rows() + lower.rows(), 3);
  result << upper, lower;
  return result;
}

Points moved(const Motion& motion, const Points& points) {
  return (points * motion.linear.transpose()).rowwise() + motion.translation.transpose();
}

Points each_its_own(const Points& viewpoints, Eigen::Index count) {
  if (viewpoints.rows() == count || viewpoints.rows() != 1) return viewpoints;
  return viewpoints.replicate(count, 1);
}

void append(const PlacedScan& part, const Motion& into, int view, PlacedScan& all) {
  PreparedScan& scan = all.scan;
  const Eigen::Index before = scan.points.rows();
  const Eigen::Index more = part.scan.points.rows();
  const Points own = each_its_own(scan.viewpoints, before);
  const Points theirs = each_its_own(part.scan.viewpoints, more);
  const bool seen_from = own.rows() == before && theirs.rows() == more;
  scan.viewpoints = seen_from ? stacked_rows(own, moved(into, theirs)) : Points(0, 3);
  scan.points = stacked_rows(scan.points, moved(into, part.scan.points));
  scan.normals = stacked_rows(scan.normals, part.scan.normals * into.linear.transpose());
  scan.normals_oriented = scan.normals_oriented && part.scan.normals_oriented;
  scan.spacing = std::max(scan.spacing, part.scan.spacing);
  scan.noise = std::max(scan.noise, part.scan.noise);
  all.view_of.resize(static_cast<std::size_t>(scan.points.rows()), view);
}

// What all scans make out together: means over their points.
struct Overlaps {
  double points = 0, used = 0, torn_off = 0;

  void add(const PointCloud& cloud, const PlacedScan& part) {
    const auto count = static_cast<double>(cloud.points.rows());
    points += count;
    used += count * part.overlap;
    torn_off += count * part.torn_off;
  }
};

// Where the shape is in another scan, at its own scale; nothing where that explains less of the scan than a fit to it
// alone would have to. Where it is as well supported where the first scan has it, the two scans have one frame.
std::optional<PlacedScan> place_in(const PointCloud& cloud, const MatchSurface& surface,
                                   const SymmetryAnnotation& annotation, const FitOptions& options,
                                   const ScanPreparationOptions& preparation, const RunContext& context) {
  PlacementOptions same_size = options.placement;
  same_size.scale = 1;  // all scans have that of the first
  const std::vector<Placement> found = find_placements(surface, annotation, cloud, same_size, context, Similarity{});
  if (found.empty()) return std::nullopt;
  const bool one_frame = std::ranges::any_of(found, [&](const Placement& placement) {
    return placement.score() >= options.tie * found.front().score() &&
           near_given(surface.mesh(), placement.pose, Similarity{});
  });
  const Similarity pose = one_frame ? Similarity{} : found.front().pose;
  std::optional<PlacedScan> part = placed_scan(surface, cloud, pose, 0, options.placement, preparation, context);
  if (!part || part->overlap < options.min_inlier_ratio) return std::nullopt;
  if (!one_frame) part->pose = align_rigidly(surface, part->scan, pose, context);
  return part;
}

// What the viewpoints that are known saw, in the frame of the first scan.
PointCloud joined_cloud(const FitInput& input, const PlacedScan& start) {
  PointCloud result;
  result.points.resize(0, 3);
  result.viewpoints.resize(0, 3);
  const auto add = [&](const PointCloud& cloud, const Motion& into) {
    const Points viewpoints = each_its_own(cloud.viewpoints, cloud.points.rows());
    if (viewpoints.rows() != cloud.points.rows()) return;
    result.points = stacked_rows(result.points, moved(into, cloud.points));
    result.viewpoints = stacked_rows(result.viewpoints, moved(into, viewpoints));
  };
  add(input.scan, Motion{});
  for (std::size_t k = 0; k < start.others.size(); ++k) {
    if (start.other_used[k] != 0) add(*input.others[k], start.others[k]);
  }
  return result;
}

}  // namespace

PlacedScan join_scans(const FitInput& input, const PlacedScan& start, const FitResult& fitted,
                      const FitOptions& options, const RunContext& context) {
  constexpr int kMinPoints = 500;  // points of one of the scans
  ScanPreparationOptions preparation;
  preparation.most_points = std::max(kMinPoints, options.scan_points / (1 + static_cast<int>(input.others.size())));
  const MatchSurface surface(fitted.fitted);
  PlacedScan result = start;
  if (auto own = placed_scan(surface, input.scan, Similarity{}, 0, options.placement, preparation, context)) {
    own->pose = start.pose;
    own->scale_open = start.scale_open;
    result = std::move(*own);
  }
  Overlaps overlaps;
  overlaps.add(input.scan, result);
  result.view_of.assign(static_cast<std::size_t>(result.scan.points.rows()), 0);
  for (std::size_t k = 0; k < input.others.size(); ++k) {
    const auto part = place_in(*input.others[k], surface, fitted.annotation, options, preparation, context);
    const Similarity into = part ? inverse(part->pose) : Similarity{};
    result.others.push_back({into.linear, into.translation});
    result.other_used.push_back(part ? 1 : 0);
    if (part) {
      append(*part, result.others.back(), static_cast<int>(k) + 1, result);
      overlaps.add(*input.others[k], *part);
    } else {
      context.message("left out scan " + std::to_string(k + 2) + ": the shape of scan 1 is not found in it");
    }
  }
  result.overlap = overlaps.used / overlaps.points;
  result.torn_off = overlaps.torn_off / overlaps.points;
  result.views = std::make_shared<const ScanViews>(input.mesh, moving_template(result, input.mesh),
                                                   joined_cloud(input, result), result.scan, context);
  return result;
}

}  // namespace orbifit

#include "joined_scans.h"

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

// At another scale about the template's middle.
Similarity rescaled(const Similarity& pose, double scale, const Mesh& mesh) {
  const Eigen::Vector3d centre = bounding_box_centre(mesh.vertices);
  return {scale, pose.linear, pose(centre) - scale * (pose.linear * centre)};
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

// Where the template is in another scan, at the scale of the first.
struct OtherPose {
  Similarity pose;
  bool one_frame = false;
};

OtherPose other_pose(const std::vector<Placement>& found, const Mesh& mesh, const Similarity& first, double tie) {
  for (const Placement& placement : found) {
    if (placement.score() < tie * found.front().score()) break;
    if (near_given(mesh, placement.pose, first)) return {first, true};
  }
  return {rescaled(found.front().pose, first.scale, mesh), false};
}

PlacedScan joined(const FitInput& input, const MatchSurface& surface, const FitOptions& options,
                  const ScanPreparationOptions& preparation, const std::vector<std::vector<Placement>>& found,
                  const RunContext& context, const PlacedScan& first) {
  PlacedScan result = first;
  result.view_of.assign(static_cast<std::size_t>(first.scan.points.rows()), 0);
  auto weight = static_cast<double>(input.scan.points.rows());
  double overlap = weight * first.overlap;
  double torn_off = weight * first.torn_off;
  for (std::size_t k = 0; k < input.others.size(); ++k) {
    result.others.emplace_back();
    result.other_used.push_back(0);
    if (found[k].empty()) continue;
    const PointCloud& cloud = *input.others[k];
    const auto [pose, one_frame] = other_pose(found[k], surface.mesh(), first.pose, options.tie);
    const std::optional<PlacedScan> part =
        placed_scan(surface, cloud, pose, 0, options.placement, preparation, context);
    if (!part) continue;
    const Similarity refined = one_frame ? pose : align_rigidly(surface, part->scan, pose, context);
    const Similarity into = first.pose * inverse(refined);
    result.others.back() = {into.linear, into.translation};
    result.other_used.back() = 1;
    append(*part, result.others.back(), static_cast<int>(k) + 1, result);
    const auto count = static_cast<double>(cloud.points.rows());
    weight += count;
    overlap += count * part->overlap;
    torn_off += count * part->torn_off;
  }
  result.overlap = overlap / weight;
  result.torn_off = torn_off / weight;
  return result;
}

}  // namespace

void join_scans(const FitInput& input, const MatchSurface& surface, const FitOptions& options,
                const ScanPreparationOptions& preparation, const RunContext& context, std::vector<PlacedScan>& places) {
  if (input.others.empty()) return;
  std::vector<std::vector<Placement>> found;
  for (const PointCloud* cloud : input.others) {
    found.push_back(
        find_placements(surface, input.annotation, *cloud, options.placement, context, places.front().pose));
  }
  for (PlacedScan& place : places) {
    place = joined(input, surface, options, preparation, found, context, place);
  }
  for (std::size_t k = 0; k < found.size(); ++k) {
    if (places.front().other_used[k] != 0) continue;
    context.message("left out scan " + std::to_string(k + 2) + ": the template is not found in it");
  }
}

PlacedScan rejoined(const PlacedScan& start, const Similarity& pose, const std::vector<Motion>& moves) {
  PlacedScan result = start;
  result.scan = with_others_moved(start, moves);
  result.pose = pose;
  for (std::size_t k = 0; k < moves.size(); ++k) result.others[k] = moves[k] * start.others[k];
  return result;
}

PointCloud joined_cloud(const FitInput& input, const PlacedScan& start) {
  PointCloud result;
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

}  // namespace orbifit

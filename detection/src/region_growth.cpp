#include "orbifit/detection/region_growth.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "orbifit/detection/verification.h"
#include "orbifit/model/point_index.h"
#include "orbifit/model/random.h"

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Family = PointGroup::Family;

constexpr double kNormalCosine = 0.90630778703665;  // 25 degrees
constexpr int kComponentSamples = 48;
constexpr double kKeptShare = 0.9;

bool rotates_all(const PointGroup& group) {
  return group.family == Family::K || group.family == Family::Kh;
}

// Whether the element is one of the continuous group about the axis, to an angle.
bool member(const Matrix3d& linear, const PointGroup& group, const Vector3d& axis, double angle) {
  const bool proper = linear.determinant() > 0;
  if (group.family == Family::Kh) return true;
  if (group.family == Family::K) return proper;
  const Vector3d image = linear * axis;
  if (image.cross(axis).norm() > angle) return false;
  const bool up = image.dot(axis) > 0;
  switch (group.family) {
    case Family::Cinf:
      return proper && up;
    case Family::Cinfv:
      return up;
    case Family::Cinfh:
      return proper == up;
    case Family::Dinf:
      return proper;
    default:
      return true;
  }
}

}  // namespace

bool contains_group(const GroupPlacement& outer, const GroupPlacement& inner, const Vector3d& centre, double reach,
                    double tolerance) {
  const double angle = tolerance / std::max(reach, 1e-9);
  if (inner.group.continuous()) {
    if (!outer.group.continuous()) return false;
    if (rotates_all(inner.group)) {
      return rotates_all(outer.group) && (outer.centre - inner.centre).norm() <= tolerance &&
             (outer.group.family == Family::Kh || inner.group.family == Family::K);
    }
  }
  if (!outer.group.continuous() && inner.group.order() > outer.group.order()) return false;
  const std::vector<Motion> wanted = judged_motions(inner.group, inner.frame, inner.centre);
  if (outer.group.continuous()) {
    return std::ranges::all_of(wanted, [&](const Motion& motion) {
      if (!member(motion.linear, outer.group, outer.frame.col(2), angle)) return false;
      // The element must also leave the outer group's fixed set in place.
      Vector3d moved = motion(outer.centre) - outer.centre;
      const bool slides = outer.group.family == Family::Cinf || outer.group.family == Family::Cinfv;
      if (slides) moved -= outer.frame.col(2) * outer.frame.col(2).dot(moved);
      return moved.norm() <= 2 * tolerance;
    });
  }
  const std::vector<Motion> have = judged_motions(outer.group, outer.frame, outer.centre);
  return std::ranges::all_of(wanted, [&](const Motion& motion) {
    return std::ranges::any_of(
        have, [&](const Motion& other) { return motion_distance(motion, other, centre, reach) <= 3 * tolerance; });
  });
}

std::vector<int> permuted_components(const PreparedMesh& prepared, const ComponentSurvey& survey,
                                     const SurfaceIndex& whole, const GroupPlacement& placement,
                                     const std::vector<int>& seed, double tolerance, const RunContext& context) {
  const std::size_t count = survey.moments.size();
  std::vector<char> in(count, 0);
  for (const int c : seed) in[static_cast<std::size_t>(c)] = 1;
  if (seed.size() == count) return seed;
  Points centroids(static_cast<Eigen::Index>(count), 3);
  for (std::size_t c = 0; c < count; ++c) centroids.row(static_cast<Eigen::Index>(c)) = survey.moments[c].centroid;
  const PointIndex index(centroids);
  const std::vector<Motion> motions = judged_motions(placement.group, placement.frame, placement.centre);

  // images[c]: the components onto which the group carries c; empty when it does not.
  std::vector<std::vector<int>> images(count);
  for (std::size_t c = 0; c < count; ++c) {
    context.check();
    const SurfaceMoments& mine = survey.moments[c];
    if (in[c] != 0 || mine.area <= 0) continue;
    const double close = tolerance * std::min(1.0, 4 * mine.diagonal);
    std::vector<int> targets;
    const bool placed = std::ranges::all_of(motions, [&](const Motion& motion) {
      for (const PointIndex::Neighbour& near : index.within(motion(mine.centroid), 1.5 * close)) {
        const SurfaceMoments& other = survey.moments[static_cast<std::size_t>(near.index)];
        if (std::abs(other.area - mine.area) > 0.05 * mine.area) continue;
        if (std::abs(other.radius - mine.radius) > 2 * close) continue;
        targets.push_back(near.index);
        return true;
      }
      return false;
    });
    if (!placed) continue;
    std::vector<int> visible;
    for (const int f : prepared.components.faces[c]) {
      if (prepared.areas[f] > 0) visible.push_back(f);
    }
    Random random(context.seed, "growth");
    const SurfaceSamples samples = sample_surface(prepared.mesh, kComponentSamples, random, visible);
    const double bound =
        placement.group.continuous() ? std::min(close, 2 * tolerance * std::max(mine.radius, 1e-9)) : close;
    const bool kept = std::ranges::all_of(motions, [&](const Motion& motion) {
      int hits = 0;
      for (Eigen::Index s = 0; s < samples.points.rows(); ++s) {
        const Vector3d normal = motion.linear * samples.normals.row(s).transpose();
        const Vector3d image = motion(samples.points.row(s));
        if (whole.nearest_facing(image, normal, kNormalCosine, bound, true).face >= 0) ++hits;
      }
      return hits >= kKeptShare * kComponentSamples;
    });
    if (!kept) continue;
    std::ranges::sort(targets);
    targets.erase(std::ranges::unique(targets).begin(), targets.end());
    images[c] = std::move(targets);
    in[c] = 1;
  }
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t c = 0; c < count; ++c) {
      if (in[c] == 0 || images[c].empty()) continue;
      const bool stays = std::ranges::all_of(images[c], [&](int t) { return in[static_cast<std::size_t>(t)] != 0; });
      if (stays) continue;
      in[c] = 0;
      changed = true;
    }
  }
  std::vector<int> result;
  for (std::size_t c = 0; c < count; ++c) {
    if (in[c] != 0) result.push_back(static_cast<int>(c));
  }
  return result;
}

}  // namespace orbifit

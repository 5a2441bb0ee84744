#include "support/region_growth.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>
#include <optional>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "base/random.h"
#include "group/patterns.h"
#include "group/subgroups_within.h"
#include "group/verification.h"
#include "surface/thresholds.h"

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Family = PointGroup::Family;

constexpr int kComponentSamples = 96;
constexpr double kKeptShare = 0.9;
constexpr double kKeptByAll = 0.96;  // by rotations of a continuous group: a regular polygon keeps 0.9 of itself

bool rotates_all(const PointGroup& group) {
  return group.family == Family::K || group.family == Family::Kh;
}

constexpr int kMaxElements = 150;
constexpr std::size_t kMaxMasks = 12;

// Of the components `in`, those that are left, ascending, when what has an image outside has been taken out until
// nothing has. \param images  by component: those it must have, -1 for nowhere; none of what stays in any case
std::vector<int> closed_under(const std::vector<std::vector<int>>& images, std::vector<char> in) {
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t c = 0; c < in.size(); ++c) {
      if (in[c] == 0) continue;
      if (std::ranges::all_of(images[c], [&](int t) { return t >= 0 && in[static_cast<std::size_t>(t)] != 0; })) {
        continue;
      }
      in[c] = 0;
      changed = true;
    }
  }
  std::vector<int> result;
  for (std::size_t c = 0; c < in.size(); ++c) {
    if (in[c] != 0) result.push_back(static_cast<int>(c));
  }
  return result;
}

// The sets of elements that have an image of some component, each set once. Of the identity alone: none.
std::vector<std::vector<char>> distinct_masks(const std::vector<std::vector<int>>& images) {
  std::vector<std::vector<char>> distinct;
  for (const std::vector<int>& of_component : images) {
    std::vector<char> mask(of_component.size());
    std::ranges::transform(of_component, mask.begin(), [](int image) { return image >= 0 ? 1 : 0; });
    if (std::ranges::count(mask, 1) > 1 && std::ranges::find(distinct, mask) == distinct.end()) {
      distinct.push_back(std::move(mask));
    }
  }
  return distinct;
}

}  // namespace

GroupElements::GroupElements(const GroupPlacement& placement) : placement_(placement) {
  if (placement.group.continuous()) return;
  finite_ = judged_motions(placement.group, placement.frame, placement.centre);
  finite_.emplace_back();
}

bool GroupElements::hold(const Motion& motion, const Vector3d& centre, double reach, double tolerance) const {
  const PointGroup& group = placement_.group;
  if (!group.continuous()) {
    return std::ranges::any_of(finite_, [&](const Motion& element) {
      return motion_distance(motion, element, centre, reach) <= 3 * tolerance;
    });
  }
  const Vector3d axis = placement_.frame.col(2);
  if (!belongs_to_continuous(motion.linear, group, axis, tolerance / std::max(reach, 1e-9))) return false;
  // The element must also leave the group's fixed set in place.
  Vector3d moved = motion(placement_.centre) - placement_.centre;
  const bool slides = group.family == Family::Cinf || group.family == Family::Cinfv;
  if (slides) moved -= axis * axis.dot(moved);
  return moved.norm() <= 2 * tolerance;
}

bool contains_group(const GroupPlacement& outer, const GroupPlacement& inner, const Vector3d& centre, double reach,
                    double tolerance) {
  if (inner.group.continuous()) {
    if (!outer.group.continuous()) return false;
    if (rotates_all(inner.group)) {
      return rotates_all(outer.group) && (outer.centre - inner.centre).norm() <= tolerance &&
             (outer.group.family == Family::Kh || inner.group.family == Family::K);
    }
  }
  if (!outer.group.continuous() && inner.group.order() > outer.group.order()) return false;
  const GroupElements elements_of_outer(outer);
  return std::ranges::all_of(judged_motions(inner.group, inner.frame, inner.centre), [&](const Motion& motion) {
    return elements_of_outer.hold(motion, centre, reach, tolerance);
  });
}

ComponentMover::ComponentMover(const PreparedMesh& prepared, const ComponentSurvey& survey, const SurfaceIndex& whole,
                               double tolerance, const RunContext& context)
    : prepared_(prepared),
      survey_(survey),
      whole_(whole),
      tolerance_(tolerance),
      context_(context),
      places_(survey.moments.size()),
      continuous_own_(survey.classes.size()),
      own_(survey.classes.size()),
      samples_(survey.moments.size()) {
  for (std::size_t k = 0; k < survey.classes.size(); ++k) {
    own_[k].emplace_back();
    for (std::size_t i = 0; i < survey.classes[k].members.size(); ++i) {
      places_[static_cast<std::size_t>(survey.classes[k].members[i])] = {static_cast<int>(k),
                                                                         survey.classes[k].motions[i]};
    }
  }
  Points centroids(static_cast<Eigen::Index>(survey.moments.size()), 3);
  for (std::size_t c = 0; c < survey.moments.size(); ++c) {
    centroids.row(static_cast<Eigen::Index>(c)) = survey.moments[c].centroid;
  }
  centroids_ = std::make_unique<PointIndex>(centroids);
  parallel_for(context, samples_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) samples_[c] = samples_of(c);
  });
}

SurfaceSamples ComponentMover::samples_of(std::size_t component) const {
  if (survey_.moments[component].area <= 0) return {};
  std::vector<int> visible;
  for (const int f : prepared_.components.faces[component]) {
    if (prepared_.areas[f] > 0) visible.push_back(f);
  }
  Random random(context_.seed, "growth");
  return sample_surface(prepared_.mesh, prepared_.areas, prepared_.normals, kComponentSamples, random, visible);
}

void ComponentMover::know(std::size_t number, const GroupPlacement& own) {
  if (own.group.continuous()) {
    continuous_own_[number] = own;
    return;
  }
  const std::vector<Motion> motions = judged_motions(own.group, own.frame, own.centre);
  own_[number].insert(own_[number].end(), motions.begin(), motions.end());
}

bool ComponentMover::carries(std::size_t component, std::size_t target, const Motion& motion, double reach) const {
  const Place& from = places_[component];
  const Place& to = places_[target];
  if (from.number < 0 || from.number != to.number) return false;
  const auto number = static_cast<std::size_t>(from.number);
  const auto first = static_cast<std::size_t>(survey_.classes[number].members.front());
  const SurfaceMoments& moments = survey_.moments[first];
  Motion rest = inverse(to.motion) * motion * from.motion;
  if (continuous_own_[number]) rest = straightened(rest, *continuous_own_[number]);
  return std::ranges::any_of(own_[number], [&](const Motion& element) {
    return motion_distance(rest, element, moments.centroid, moments.radius) <= 0.5 * reach;
  });
}

int ComponentMover::image(std::size_t component, const Motion& motion, double reach, double least_share) const {
  const SurfaceMoments& mine = survey_.moments[component];
  if (mine.area <= 0) return -1;
  int target = -1;
  for (const PointIndex::Neighbour& near : centroids_->within(motion(mine.centroid), 1.5 * reach)) {
    const SurfaceMoments& other = survey_.moments[static_cast<std::size_t>(near.index)];
    if (std::abs(other.area - mine.area) > 0.05 * mine.area) continue;
    if (std::abs(other.radius - mine.radius) > 2 * reach) continue;
    target = near.index;
    break;
  }
  if (target < 0) return -1;
  if (carries(component, static_cast<std::size_t>(target), motion, reach)) return target;
  const SurfaceSamples& samples = samples_[component];
  int hits = 0;
  for (Eigen::Index s = 0; s < samples.points.rows(); ++s) {
    const Vector3d normal = motion.linear * samples.normals.row(s).transpose();
    const Vector3d place = motion(samples.points.row(s));
    if (whole_.within_facing(place, normal, kAlikeNormals, reach)) ++hits;
    if (s + 1 - hits > (1 - least_share) * kComponentSamples) return -1;
  }
  return target;
}

double ComponentMover::reach_of(std::size_t component, const PointGroup& group) const {
  const SurfaceMoments& moments = survey_.moments[component];
  const double reach = tolerance_of_part(tolerance_, moments.diagonal);
  return group.continuous() ? std::min(reach, 2 * tolerance_ * std::max(moments.radius, 1e-9)) : reach;
}

std::vector<int> ComponentMover::permuted(const GroupPlacement& placement, const std::vector<int>& seed,
                                          double strictness) const {
  std::vector<int> all(survey_.moments.size());
  std::iota(all.begin(), all.end(), 0);
  return permuted_among(all, placement, seed, strictness);
}

std::vector<int> ComponentMover::permuted_among(const std::vector<int>& among, const GroupPlacement& placement,
                                                const std::vector<int>& seed, double strictness) const {
  const std::size_t count = survey_.moments.size();
  std::vector<char> in(count, 0);
  for (const int c : seed) in[static_cast<std::size_t>(c)] = 1;
  if (seed.size() == count) return seed;
  const std::vector<Motion> motions = judged_motions(placement.group, placement.frame, placement.centre);
  // images[c]: the components onto which the group carries c; empty for the seed.
  std::vector<std::vector<int>> images(count);
  for (const int each : among) {
    const auto c = static_cast<std::size_t>(each);
    context_.check();
    if (in[c] != 0) continue;
    const double reach = strictness * reach_of(c, placement.group);
    const double share = placement.group.continuous() ? kKeptByAll : kKeptShare;
    std::vector<int> targets;
    const bool kept = std::ranges::all_of(motions, [&](const Motion& motion) {
      targets.push_back(image(c, motion, reach, share));
      return targets.back() >= 0;
    });
    if (!kept) continue;
    images[c] = std::move(targets);
    in[c] = 1;
  }
  return closed_under(images, std::move(in));
}

std::vector<std::vector<int>> ComponentMover::element_images(const std::vector<Matrix3d>& linear,
                                                             const GroupPlacement& placement,
                                                             const std::vector<char>& in_seed) const {
  std::vector<std::vector<int>> images(in_seed.size());
  for (std::size_t c = 0; c < images.size(); ++c) {
    context_.check();
    if (in_seed[c] != 0) continue;
    const double reach = reach_of(c, placement.group);
    images[c].push_back(static_cast<int>(c));
    for (std::size_t g = 1; g < linear.size(); ++g) {
      images[c].push_back(image(c, Motion::about(linear[g], placement.centre), reach, kKeptShare));
    }
  }
  return images;
}

std::vector<SubgroupRegion> ComponentMover::subgroup_regions(const GroupPlacement& placement,
                                                             const std::vector<int>& seed) const {
  std::vector<SubgroupRegion> result;
  if (placement.group.continuous() || placement.group.order() < 4 || placement.group.order() > kMaxElements)
    return result;
  const std::vector<Matrix3d> linear = elements(placement.group, placement.frame);
  const std::size_t count = survey_.moments.size();
  std::vector<char> in_seed(count, 0);
  for (const int c : seed) in_seed[static_cast<std::size_t>(c)] = 1;
  const std::vector<std::vector<int>> images = element_images(linear, placement, in_seed);
  const std::vector<std::vector<char>> distinct = distinct_masks(images);
  if (distinct.empty() || distinct.size() > kMaxMasks) return result;

  for (const std::vector<char>& members : subgroups_within(linear, distinct)) {
    std::vector<Matrix3d> kept;
    std::vector<std::vector<int>> images_by_members(count);
    for (std::size_t g = 0; g < linear.size(); ++g) {
      if (members[g] == 0) continue;
      kept.push_back(linear[g]);
      for (std::size_t c = 0; c < count; ++c) {
        if (in_seed[c] == 0) images_by_members[c].push_back(images[c][g]);
      }
    }
    const std::optional<ClassifiedGroup> known = classify(kept);
    if (!known) continue;
    SubgroupRegion region{{known->group, known->frame, placement.centre},
                          closed_under(images_by_members, std::vector<char>(count, 1))};
    if (region.components.size() > seed.size()) result.push_back(std::move(region));
  }
  return result;
}

}  // namespace orbifit

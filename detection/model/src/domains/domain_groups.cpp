// How the groups of regions stand to one another.

#include <algorithm>
#include <utility>

#include "domains/domain_map.h"
#include "groups/motion_closure.h"

namespace orbifit {

namespace {

constexpr double kSameGroup = 1e-6;  // radians, and of the diagonal: consistent annotations are a million times better

}  // namespace

// Whether the motion takes the group of one region, placed, to that of another.
bool DomainMap::group_goes_to(int from, const Motion& motion, int to) const {
  const Place& a = at(from);
  const Place& b = at(to);
  if (a.motions.size() != b.motions.size() || a.continuum.has_value() != b.continuum.has_value()) return false;
  if (a.continuum) {
    if (a.continuum->spherical != b.continuum->spherical) return false;
    const double off = b.continuum->distance(motion(a.continuum->foot(a.centre)));
    if (off > kSameGroup * size_) return false;
    return a.continuum->spherical || b.continuum->axis.cross(motion.linear * a.continuum->axis).norm() < kSameGroup;
  }
  return std::ranges::all_of(a.motions, [&](const Motion& element) {
    const Motion image = conjugate(motion, element);
    return std::ranges::any_of(b.motions, [&](const Motion& other) {
      return (other.linear - image.linear).cwiseAbs().maxCoeff() < kSameGroup &&
             (other(b.centre) - image(b.centre)).norm() < kSameGroup * size_;
    });
  });
}

// Whether each motion of the one region is one of the other's.
bool DomainMap::group_within(int inner, int outer) const {
  const Place& a = at(inner);
  const Place& b = at(outer);
  if (!b.continuum) {
    return !a.continuum && std::ranges::all_of(a.motions, [&](const Motion& element) {
      return std::ranges::any_of(b.motions, [&](const Motion& other) {
        return (other.linear - element.linear).cwiseAbs().maxCoeff() < kSameGroup &&
               (other(b.centre) - element(b.centre)).norm() < kSameGroup * size_;
      });
    });
  }
  const Continuum& turning = *b.continuum;
  if (a.continuum && !turning.spherical &&
      (a.continuum->spherical || a.continuum->axis.cross(turning.axis).norm() > kSameGroup)) {
    return false;
  }
  if (a.continuum) {  // its axis, or centre, lies on the other's
    const Eigen::Vector3d foot = turning.spherical ? a.continuum->foot(turning.centre) : turning.foot(a.centre);
    const Eigen::Vector3d due = turning.spherical ? turning.centre : a.centre;
    if ((foot - due).norm() > kSameGroup * size_) return false;
  }
  // Of a component: whether it turns space inside out, and the axis over.
  const auto kind = [&](const Motion& motion) {
    const double along = turning.spherical ? 1 : (motion.linear * turning.axis).dot(turning.axis);
    return std::pair(motion.linear.determinant() > 0, along > 0);
  };
  return std::ranges::all_of(a.motions, [&](const Motion& element) {
    const auto [proper, upright] = kind(element);
    if (!turning.spherical && (element.linear * turning.axis).cross(turning.axis).norm() > kSameGroup) return false;
    const Eigen::Vector3d moved = element(turning.centre) - turning.centre;
    if (moved.norm() > kSameGroup * size_) return false;
    return std::ranges::any_of(b.motions,
                               [&, p = proper, u = upright](const Motion& m) { return kind(m) == std::pair(p, u); });
  });
}

// \param sets  of all faces and vertices
void DomainMap::find_followers(const std::vector<int>& sets) {
  std::set<std::pair<int, int>> apart;
  for (const int set : sets) {
    const std::vector<int>& places = set_places(set);
    for (const int a : places) {
      for (const int b : places) {
        if (a >= b || b >= count() || around(a, b) || around(b, a) || apart.contains({a, b})) continue;
        const bool held = std::ranges::any_of(places, [&](int outer) {
          return outer < count() && outer != a && outer != b && around(a, outer) && around(b, outer) &&
                 group_within(a, outer) && group_within(b, outer);
        });
        if (held) {
          following_.emplace(a, b);
        } else {
          apart.emplace(a, b);
        }
      }
    }
  }
  std::erase_if(following_, [&](const auto& pair) { return apart.contains(pair); });
}

// Whether the motions of the one region take the other to regions with its group, carried along.
bool DomainMap::carries_group(int place, int other) const {
  for (int element = 0; element < static_cast<int>(elements(place).size()); ++element) {
    const Motion& motion = elements(place)[static_cast<std::size_t>(element)];
    const std::vector<int> images = images_of(other, place, element);
    if (images.empty()) return false;
    if (!std::ranges::all_of(images, [&](int image) { return group_goes_to(other, motion, image); })) return false;
  }
  return true;
}

// Whether the motions of both regions together make a finite group, or keep the axis, or centre, of a continuous one.
bool DomainMap::make_a_group(int a, int b) const {
  for (const auto& [turning, other] : {std::pair(a, b), std::pair(b, a)}) {
    if (!at(turning).continuum) continue;
    const auto& motions = at(other).motions;
    return std::ranges::all_of(motions, [&, t = turning](const Motion& m) { return group_goes_to(t, m, t); }) &&
           (!at(other).continuum || group_within(a, b) || group_within(b, a));
  }
  std::vector<Motion> generators = at(a).motions;
  generators.insert(generators.end(), at(b).motions.begin(), at(b).motions.end());
  return closure(generators, {at(a).centre, size_}, kSameGroup * size_).size() < kMaxStabilisers;
}

// Whether they do by themselves, without a third.
bool DomainMap::groups_close(int a, int b) const {
  const auto [known, added] = closing_.try_emplace({a, b}, false);
  if (added) known->second = carries_group(a, b) || carries_group(b, a) || make_a_group(a, b);
  return known->second;
}

std::vector<std::pair<int, int>> DomainMap::unclosed(int set) const {
  std::vector<std::pair<int, int>> result;
  std::vector<int> regions = set_places(set);
  std::erase_if(regions, [&](int place) { return place >= count(); });
  for (const int b : regions) {
    for (const int a : regions) {
      if (a >= b || groups_close(a, b)) continue;
      const bool held = std::ranges::any_of(regions, [&](int outer) {
        return outer != a && outer != b && group_within(a, outer) && group_within(b, outer);
      });
      if (!held) result.emplace_back(a, b);
    }
  }
  return result;
}

}  // namespace orbifit

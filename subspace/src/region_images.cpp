// Where the motions of places take other places.

#include <algorithm>
#include <cmath>
#include <limits>

#include "orbifit/subspace/region_map.h"

namespace orbifit {

namespace {

constexpr double kTie = 1e-6;  // of the diagonal: places of the same faces

bool is_identity(const Motion& motion) {
  return motion.linear.isIdentity(0) && motion.translation.isZero(0);
}

}  // namespace

// Of the faces that both places hold.
PieceMoments RegionMap::common_moments(int a, int b) const {
  PieceMoments result;
  for (std::size_t set = 0; set < moments_.size(); ++set) {
    if (holds(static_cast<int>(set), a) && holds(static_cast<int>(set), b)) result += moments_[set];
  }
  return result;
}

bool RegionMap::around(int outer, int inner) const {
  for (std::size_t set = 0; set < moments_.size(); ++set) {
    if (holds(static_cast<int>(set), inner) && !holds(static_cast<int>(set), outer)) return false;
  }
  return true;
}

// As the moments have it.
Motion RegionMap::told_from_origin(const Motion& motion) const {
  return Motion{Eigen::Matrix3d::Identity(), -origin_} * motion * Motion{Eigen::Matrix3d::Identity(), origin_};
}

RegionMap::Images RegionMap::find_images(int place, int element) const {
  Images result;
  const int arrival = this->arrival(place, element);
  const Motion& motion = at(place).motions[static_cast<std::size_t>(element)];
  const std::vector<int>& here = meeting_[static_cast<std::size_t>(place)];
  const std::vector<int>& there = meeting_[static_cast<std::size_t>(arrival)];
  if (is_identity(motion)) {
    for (const int p : here) result.pairs.emplace_back(p, p);
    result.reached = here;
    result.all = true;
    return result;
  }
  const Motion told = told_from_origin(motion);
  std::vector<PieceMoments> common;
  common.reserve(there.size());
  for (const int q : there) common.push_back(common_moments(arrival, q));
  const auto alike = [&](int p, int q) {
    return (p < count()) == (q < count()) && at(p).motions.size() == at(q).motions.size() &&
           at(p).continuum.has_value() == at(q).continuum.has_value();
  };
  for (const int p : here) {
    // A place all around, or the place itself, stays.
    if (p == place || (std::ranges::binary_search(there, p) && around(p, place) && around(p, arrival))) {
      result.pairs.emplace_back(p, p == place ? arrival : p);
      continue;
    }
    const PieceMoments piece = common_moments(place, p);
    double best = same_place_;
    std::vector<std::pair<double, int>> found;
    for (std::size_t k = 0; k < there.size(); ++k) {
      if (!alike(p, there[k])) continue;
      const double miss = mismatch(piece, told, common[k], size_);
      if (miss <= same_place_) found.emplace_back(miss, there[k]);
      best = std::min(best, miss);
    }
    for (const auto& [miss, q] : found) {
      if (miss <= best + kTie) result.pairs.emplace_back(p, q);
    }
  }
  for (const auto& [p, q] : result.pairs) result.reached.push_back(q);
  std::ranges::sort(result.reached);
  result.reached.erase(std::unique(result.reached.begin(), result.reached.end()), result.reached.end());
  result.all = result.reached.size() == there.size();
  return result;
}

RegionMap::Images& RegionMap::images(int place, int element) const {
  auto& images = images_[static_cast<std::size_t>(place)];
  if (images.empty()) images.resize(elements(place).size());
  auto& entry = images[static_cast<std::size_t>(element)];
  if (!entry) entry = std::make_unique<Images>(find_images(place, element));
  return *entry;
}

std::vector<int> RegionMap::exact_images(int place, int element) const {
  constexpr double kExact = 1e-9;  // of the diagonal, and of the area
  constexpr int kNone = -1;
  std::vector<int> result(static_cast<std::size_t>(places()), kNone);
  if (element < 0) return result;
  const Motion told = told_from_origin(at(place).motions[static_cast<std::size_t>(element)]);
  for (const auto& [from, to] : images(place, element).pairs) {
    if (!around(place, from) || !around(arrival(place, element), to)) continue;
    const PieceMoments here = common_moments(place, from);
    const PieceMoments there = common_moments(arrival(place, element), to);
    if (std::abs(here.area - there.area) > kExact * here.area || mismatch(here, told, there, size_) > kExact) continue;
    result[static_cast<std::size_t>(from)] = to;
  }
  return result;
}

std::vector<int> RegionMap::images_of(int other, int place, int element) const {
  std::vector<int> result;
  for (const auto& [from, to] : images(place, element).pairs) {
    if (from == other) result.push_back(to);
  }
  return result;
}

int RegionMap::carried_set(int set, int place, int element) const {
  Images& known = images(place, element);
  const auto [entry, added] = known.sets.try_emplace(set, -1);
  if (added) {
    std::vector<int> members{arrival(place, element)};
    for (const auto& [from, to] : known.pairs) {
      if (holds(set, from)) members.push_back(to);
    }
    std::ranges::sort(members);
    members.erase(std::unique(members.begin(), members.end()), members.end());
    entry->second = intern(members);
  }
  return entry->second;
}

int RegionMap::set_of_image(int set, int place, int element, const Eigen::Vector3d& image,
                            const Eigen::Vector3d& normal) const {
  int result = carried_set(set, place, element);
  const Images& known = images(place, element);
  if (known.all) return result;
  const int near = set_near(image, arrival(place, element), normal);
  if (contains(result, near)) return result;
  for (const int other : std::vector<int>(set_places(near))) {
    if (!std::ranges::binary_search(known.reached, other)) result = with(result, other);
  }
  return result;
}

}  // namespace orbifit

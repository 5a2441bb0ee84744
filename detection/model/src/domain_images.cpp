// Where the motions of places take other places.

#include <algorithm>
#include <cmath>
#include <limits>

#include "orbifit/model/domain_map.h"

namespace orbifit {

namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();
constexpr double kSameGroup = 1e-6;  // radians, and of the diagonal: consistent annotations are a million times better

bool is_identity(const Motion& motion) {
  return motion.linear.isIdentity(0) && motion.translation.isZero(0);
}

}  // namespace

// Of the faces that both places hold; of all of the second where they merely touch.
PieceMoments DomainMap::common_moments(int a, int b) const {
  PieceMoments result;
  for (std::size_t set = 0; set < moments_.size(); ++set) {
    if (holds(static_cast<int>(set), a) && holds(static_cast<int>(set), b)) result += moments_[set];
  }
  if (result.area > 0) return result;
  for (std::size_t set = 0; set < moments_.size(); ++set) {
    if (holds(static_cast<int>(set), b)) result += moments_[set];
  }
  return result;
}

bool DomainMap::around(int outer, int inner) const {
  for (std::size_t set = 0; set < moments_.size(); ++set) {
    if (holds(static_cast<int>(set), inner) && !holds(static_cast<int>(set), outer)) return false;
  }
  return true;
}

// As the moments have it.
Motion DomainMap::told_from_origin(const Motion& motion) const {
  return Motion{Eigen::Matrix3d::Identity(), -origin_} * motion * Motion{Eigen::Matrix3d::Identity(), origin_};
}

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

DomainMap::Images DomainMap::find_images(int place, int element) const {
  Images result;
  const int arrival = this->arrival(place, element);
  const Motion& motion = at(place).motions[static_cast<std::size_t>(element)];
  const std::vector<int>& here = meeting_[static_cast<std::size_t>(place)];
  const std::vector<int>& there = meeting_[static_cast<std::size_t>(arrival)];
  if (is_identity(motion)) {
    for (const int p : here) result.pairs.emplace_back(p, p);
    return result;
  }
  const Motion told = told_from_origin(motion);
  std::vector<PieceMoments> common;
  common.reserve(there.size());
  std::vector<int> candidates;
  for (const int q : there) common.push_back(common_moments(arrival, q));
  for (const int p : here) {
    // A place all around, or the place itself, stays.
    if (p == place || (std::ranges::binary_search(there, p) && around(p, place) && around(p, arrival))) {
      result.pairs.emplace_back(p, p == place ? arrival : p);
      continue;
    }
    candidates.push_back(p);
  }
  // One for each of those whose group is the image of its group, nearest pairs first; instances of patterns have no
  // group.
  Eigen::MatrixXd off = Eigen::MatrixXd::Constant(static_cast<Eigen::Index>(candidates.size()),
                                                  static_cast<Eigen::Index>(there.size()), kFar);
  for (Eigen::Index i = 0; i < off.rows(); ++i) {
    const int p = candidates[static_cast<std::size_t>(i)];
    const PieceMoments piece = common_moments(place, p);
    for (Eigen::Index k = 0; k < off.cols(); ++k) {
      const int q = there[static_cast<std::size_t>(k)];
      if ((p < count()) != (q < count()) || (p < count() && !group_goes_to(p, motion, q))) continue;
      off(i, k) = separation(piece, told, common[static_cast<std::size_t>(k)], size_);
    }
  }
  struct Pair {
    double off;
    Eigen::Index from, to;
  };
  std::vector<Pair> pairs;
  for (Eigen::Index i = 0; i < off.rows(); ++i) {
    for (Eigen::Index k = 0; k < off.cols(); ++k) {
      if (off(i, k) < kFar) pairs.push_back({off(i, k), i, k});
    }
  }
  std::ranges::stable_sort(pairs, {}, &Pair::off);
  std::vector<char> gone(candidates.size(), 0);
  std::vector<char> come(there.size(), 0);
  for (const Pair& pair : pairs) {
    char& from = gone[static_cast<std::size_t>(pair.from)];
    char& to = come[static_cast<std::size_t>(pair.to)];
    if (from != 0 || to != 0) continue;
    from = to = 1;
    result.pairs.emplace_back(candidates[static_cast<std::size_t>(pair.from)],
                              there[static_cast<std::size_t>(pair.to)]);
  }
  std::ranges::sort(result.pairs);
  return result;
}

DomainMap::Images& DomainMap::images(int place, int element) const {
  auto& images = images_[static_cast<std::size_t>(place)];
  if (images.empty()) images.resize(elements(place).size());
  auto& entry = images[static_cast<std::size_t>(element)];
  if (!entry) entry = std::make_unique<Images>(find_images(place, element));
  return *entry;
}

std::vector<int> DomainMap::exact_images(int place, int element) const {
  constexpr double kExact = 1e-9;  // of the diagonal, and of the area
  constexpr int kNone = -1;
  std::vector<int> result(static_cast<std::size_t>(places()), kNone);
  if (element < 0) return result;
  const Motion told = told_from_origin(at(place).motions[static_cast<std::size_t>(element)]);
  for (const auto& [from, to] : images(place, element).pairs) {
    if (!around(place, from) || !around(arrival(place, element), to)) continue;
    const PieceMoments here = common_moments(place, from);
    const PieceMoments there = common_moments(arrival(place, element), to);
    if (std::abs(here.area - there.area) > kExact * here.area || separation(here, told, there, size_) > kExact)
      continue;
    result[static_cast<std::size_t>(from)] = to;
  }
  return result;
}

std::vector<int> DomainMap::images_of(int other, int place, int element) const {
  std::vector<int> result;
  for (const auto& [from, to] : images(place, element).pairs) {
    if (from == other) result.push_back(to);
  }
  return result;
}

int DomainMap::carried_set(int set, int place, int element) const {
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

}  // namespace orbifit

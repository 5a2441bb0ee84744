// Where the motions of places take other places.

#include <algorithm>
#include <cmath>
#include <limits>

#include "domains/domain_map.h"

namespace orbifit {

namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();
constexpr double kSamePiece = 0.0125;  // of the diagonal: 2.5 usual tolerances, as consistency's `reach`
constexpr Eigen::Index kMarks = 32;    // of a place's corners, spread over it, tell it from its twins

// Places that have no image yet, and those that are no image.
struct Unpaired {
  std::vector<int> from, to;
};

// One for each of those that are less than infinitely far apart, nearest pairs first.
template <class Distance>
void pair_nearest(Unpaired& open, std::vector<std::pair<int, int>>& pairs, const Distance& distance) {
  struct Candidate {
    double off;
    int from, to;
  };
  std::vector<Candidate> candidates;
  for (const int p : open.from) {
    for (const int q : open.to) {
      const double off = distance(p, q);
      if (off < kFar) candidates.push_back({off, p, q});
    }
  }
  std::ranges::stable_sort(candidates, {}, &Candidate::off);
  for (const Candidate& pair : candidates) {
    const auto from = std::ranges::find(open.from, pair.from);
    const auto to = std::ranges::find(open.to, pair.to);
    if (from == open.from.end() || to == open.to.end()) continue;
    pairs.emplace_back(pair.from, pair.to);
    open.from.erase(from);
    open.to.erase(to);
  }
}

bool is_identity(const Motion& motion) {
  return motion.linear.isIdentity(0) && motion.translation.isZero(0);
}

}  // namespace

const PieceMoments& DomainMap::common_faces(int a, int b) const {
  const auto [entry, added] = common_.try_emplace(std::minmax(a, b));
  if (!added) return entry->second;
  for (std::size_t set = 0; set < moments_.size(); ++set) {
    if (holds(static_cast<int>(set), a) && holds(static_cast<int>(set), b)) entry->second += moments_[set];
  }
  return entry->second;
}

// Of the faces that both places hold; of all of the second where they merely touch.
const PieceMoments& DomainMap::common_moments(int a, int b) const {
  const PieceMoments& common = common_faces(a, b);
  return common.area > 0 ? common : common_faces(b, b);
}

// Of the faces that both places hold; where they merely touch, of the vertices that both have.
PieceMoments DomainMap::common_piece(int a, int b) const {
  PieceMoments result = common_faces(a, b);
  if (result.area > 0) return result;
  for (const auto& [set, moments] : point_moments_) {
    if (holds(set, a) && holds(set, b)) result += moments;
  }
  return result;
}

// Two pinwheels at one place that turn opposite ways have the same moments: only their surfaces tell them apart.
void DomainMap::find_twins(const Mesh& mesh) {
  std::vector<std::optional<PieceMoments>> known(places_.size());
  const auto moments = [&](int place) -> const PieceMoments& {
    std::optional<PieceMoments>& of_place = known[static_cast<std::size_t>(place)];
    if (!of_place) of_place = moments_of_faces(mesh, at(place).faces, origin_);
    return *of_place;
  };
  const auto apart = [&](const PieceMoments& a, const PieceMoments& b) { return separation(a, Motion{}, b, size_); };
  const auto alike = [&](int p, int q) {
    if ((p < count()) != (q < count())) return false;
    // The sets' moments sum to the place's to rounding, and are known.
    if (apart(common_faces(p, p), common_faces(q, q)) > 2 * kSamePiece) return false;
    return at(p).faces != at(q).faces && apart(moments(p), moments(q)) <= kSamePiece;
  };
  const auto mark = [&](int place) {
    if (twins_.contains(place)) return;
    // Not the faces' centroids: flat sides may be cut into triangles either way.
    Points marks = mesh.vertices(vertices_of_faces(mesh, at(place).faces), Eigen::all);
    twins_.emplace(place, Marks{std::move(marks), {}});
  };
  for (int p = 0; p < places(); ++p) {
    for (int q = 0; q < p; ++q) {
      if (!alike(p, q)) continue;
      mark(p);
      mark(q);
    }
  }
}

// Of places that have twins: from the image of the one, some corners of it, to the other's on the average, as a
// fraction of the diagonal. 0 of others.
double DomainMap::piece_distance(int from, const Motion& motion, int to) const {
  const auto a = twins_.find(from);
  const auto b = twins_.find(to);
  if (a == twins_.end() || b == twins_.end()) return 0;
  const Eigen::Index step = 1 + (a->second.points.rows() - 1) / kMarks;
  if (!b->second.index) b->second.index.emplace(b->second.points);
  double sum = 0;
  double marks = 0;
  for (Eigen::Index i = 0; i < a->second.points.rows(); i += step, ++marks) {
    sum += b->second.index->nearest(motion(a->second.points.row(i).transpose()), 1).front().distance;
  }
  return sum / marks / size_;
}

bool DomainMap::around(int outer, int inner) const {
  return std::ranges::binary_search(around_[static_cast<std::size_t>(inner)], outer);
}

// As the moments have it.
Motion DomainMap::told_from_origin(const Motion& motion) const {
  return Motion{Eigen::Matrix3d::Identity(), -origin_} * motion * Motion{Eigen::Matrix3d::Identity(), origin_};
}

// Where a motion takes the places that meet its own: first to those of which it takes the group to the group, wherever
// they are; then to those of which it takes the common piece to the common piece.
DomainMap::Images DomainMap::find_images(int place, int element) const {
  Images result;
  const int arrival = this->arrival(place, element);
  const Motion& motion = at(place).motions[static_cast<std::size_t>(element)];
  const std::vector<int>& here = meeting_[static_cast<std::size_t>(place)];
  if (is_identity(motion)) {
    for (const int p : here) result.pairs.emplace_back(p, p);
    return result;
  }
  const Motion told = told_from_origin(motion);
  Unpaired open{{}, meeting_[static_cast<std::size_t>(arrival)]};
  for (const int p : here) {
    // A place all around, or the place itself, stays; so does one of which nothing is asked.
    const int to = p == place ? arrival : p;
    if (p == place || (around(p, place) && around(p, arrival)) || follows(p, place)) {
      result.pairs.emplace_back(p, to);
      std::erase(open.to, to);
    } else {
      open.from.push_back(p);
    }
  }
  const auto same_kind = [&](int p, int q) { return (p < count()) == (q < count()); };
  pair_nearest(open, result.pairs, [&](int p, int q) {  // instances of patterns have no group that would tell
    if (!same_kind(p, q) || (p < count() && !group_goes_to(p, motion, q))) return kFar;
    const double off = separation(common_moments(place, p), told, common_moments(arrival, q), size_);
    return p < count() || off <= kSamePiece ? off + piece_distance(p, motion, q) : kFar;
  });
  pair_nearest(open, result.pairs, [&](int p, int q) {
    if (!same_kind(p, q)) return kFar;
    const double off = separation(common_piece(place, p), told, common_piece(arrival, q), size_);
    return off <= kSamePiece ? off + piece_distance(p, motion, q) : kFar;
  });
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
  const std::vector<std::pair<int, int>>& pairs = images(place, element).pairs;
  std::vector<int> result;
  for (auto pair = std::ranges::lower_bound(pairs, std::pair(other, 0)); pair != pairs.end() && pair->first == other;
       ++pair) {
    result.push_back(pair->second);
  }
  return result;
}

int DomainMap::carried_set(int set, int place, int element) const {
  Images& known = images(place, element);
  if (known.last.first == set) return known.last.second;
  const auto [entry, added] = known.sets.try_emplace(set, -1);
  if (added) {
    std::vector<int> members = around_[static_cast<std::size_t>(arrival(place, element))];
    const std::vector<int>& places = set_places(set);
    auto next = places.begin();
    for (const auto& [from, to] : known.pairs) {  // both ascend
      next = std::lower_bound(next, places.end(), from);
      if (next != places.end() && *next == from) members.push_back(to);
    }
    std::ranges::sort(members);
    members.erase(std::unique(members.begin(), members.end()), members.end());
    entry->second = intern(members);
  }
  known.last = *entry;
  return entry->second;
}

}  // namespace orbifit

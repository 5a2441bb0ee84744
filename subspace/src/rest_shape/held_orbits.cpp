#include "rest_shape/held_orbits.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace orbifit {

namespace {

constexpr double kHeldRounding = 1e-13;  // of the diagonal
constexpr double kTurned = 0.5;          // cosine: how far a face's normal may turn
constexpr double kThin = 1e-5;           // of the diagonal: the height of faces of which nobody sees the side
constexpr double kAside = 1e-9;          // barycentric weight of a corner that has no part in a point

std::vector<GapSummary> summarised(const ImagePairs& pairs, const std::vector<SurfaceMatch>& matches) {
  std::vector<GapSummary> result(pairs.demands().size());
  std::size_t pair = 0;
  for (std::size_t r = 0; r < result.size(); ++r) {
    const RegionDemand& demand = pairs.demands()[r];
    result[r].pairs = demand.probes.size() * demand.motions.size();
    for (std::size_t i = 0; i < result[r].pairs; ++i, ++pair) {
      result[r].max = std::max(result[r].max, matches[pair].distance);
      result[r].squares += matches[pair].distance * matches[pair].distance;
    }
  }
  return result;
}

// Of the faces at a side of a face the one that goes on most smoothly; none where very many meet.
std::vector<Eigen::RowVector3i> smoothest_partners(const ImagePairs& pairs, const Points& normals) {
  constexpr std::size_t kMany = 16;
  struct Side {
    std::array<int, 2> ends;
    int face, number;
  };
  std::vector<Side> sides;
  for (int face = 0; face < pairs.faces(); ++face) {
    const Eigen::RowVector3i corners = pairs.corners(face);
    for (int k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(corners[k], corners[(k + 1) % 3]);
      if (low != high) sides.push_back({{low, high}, face, k});
    }
  }
  std::ranges::stable_sort(sides, {}, &Side::ends);
  std::vector<Eigen::RowVector3i> result(static_cast<std::size_t>(pairs.faces()), Eigen::RowVector3i(-1, -1, -1));
  for (std::size_t begin = 0, end = 0; begin < sides.size(); begin = end) {
    while (end < sides.size() && sides[end].ends == sides[begin].ends) ++end;
    if (end - begin > kMany) continue;
    for (std::size_t i = begin; i < end; ++i) {
      double most = -2;
      for (std::size_t k = begin; k < end; ++k) {
        const double smooth = normals.row(sides[i].face).dot(normals.row(sides[k].face));
        if (sides[k].face == sides[i].face || smooth <= most) continue;
        most = smooth;
        result[static_cast<std::size_t>(sides[i].face)][sides[i].number] = sides[k].face;
      }
    }
  }
  return result;
}

}  // namespace

HeldOrbits::HeldOrbits(ImagePairs& pairs, const std::vector<PlaceOrbit>& orbits, const Points& rest,
                       const std::vector<SurfaceMatch>& at_rest)
    : pairs_(pairs),
      orbits_(orbits),
      orbit_of_(static_cast<std::size_t>(rest.rows()), -1),
      rest_(rest),
      rounding_(kHeldRounding * diagonal(rest)),
      at_rest_(at_rest),
      normals_(normals(rest)),
      partners_(smoothest_partners(pairs, normals_)),
      before_(summarised(pairs, at_rest_)),
      held_(orbits.size(), 0) {
  for (std::size_t o = 0; o < orbits.size(); ++o) {
    for (const int member : orbits[o].members) orbit_of_[static_cast<std::size_t>(member)] = static_cast<int>(o);
  }
}

std::vector<std::vector<char>> HeldOrbits::open_places() const {
  std::vector<std::vector<char>> result;
  for (const RegionDemand& demand : pairs_.demands()) {
    result.emplace_back(demand.probes.size(), 1);
    if (!demand.of_finite_group) continue;
    for (std::size_t i = 0; i < demand.probes.size(); ++i) {
      const auto orbit = static_cast<std::size_t>(orbit_of_[static_cast<std::size_t>(demand.probes[i].place)]);
      if (orbits_[orbit].complete && held_[orbit] == 0) result.back()[i] = 0;
    }
  }
  return result;
}

std::vector<GapSummary> HeldOrbits::summary(const Points& positions, const RunContext& context) {
  const std::vector<std::vector<char>> wanted = open_places();
  return summarised(pairs_, pairs_.match(positions, &wanted, context));
}

void HeldOrbits::hold_far(const Points& positions, double most) {
  for (std::size_t o = 0; o < orbits_.size(); ++o) {
    for (const int member : orbits_[o].members) {
      if ((positions.row(member) - rest_.row(member)).norm() > most) held_[o] = 1;
    }
  }
}

Points HeldOrbits::normals(const Points& positions) const {
  Points result = Points::Zero(pairs_.faces(), 3);
  for (int face = 0; face < pairs_.faces(); ++face) {
    const Eigen::RowVector3i corners = pairs_.corners(face);
    Eigen::Matrix3d edges;
    for (int k = 0; k < 3; ++k) {
      edges.col(k) = (positions.row(corners[(k + 1) % 3]) - positions.row(corners[k])).transpose();
    }
    const Eigen::Vector3d normal = edges.col(0).cross(edges.col(1));
    const double length = normal.norm();
    if (!(length > kThin * rounding_ / kHeldRounding * edges.colwise().norm().maxCoeff())) continue;
    result.row(face) = (normal / length).transpose();
  }
  return result;
}

// The cosine against the partner that a face is turned to most; 1 without any.
double HeldOrbits::sharpest(int face, const Points& normals) const {
  double least = 1;
  for (const int partner : partners_[static_cast<std::size_t>(face)]) {
    if (partner >= 0) least = std::min(least, normals.row(face).dot(normals.row(partner)));
  }
  return least;
}

std::vector<int> HeldOrbits::folded(const Points& positions) const {
  const Points now = normals(positions);
  std::vector<int> result;
  std::size_t smoothed = 0;
  for (int face = 0; face < pairs_.faces(); ++face) {
    if (normals_.row(face).isZero(0) || !(now.row(face).dot(normals_.row(face)) < kTurned)) continue;
    const bool alone = partners_[static_cast<std::size_t>(face)] == Eigen::RowVector3i(-1, -1, -1);
    const double gained = alone ? -1 : sharpest(face, now) - sharpest(face, normals_);
    if (gained < -kTurned) result.push_back(face);
    if (gained > kTurned) ++smoothed;
  }
  if (smoothed >= result.size()) result.clear();
  return result;
}

bool HeldOrbits::hold_folded(const Points& positions) {
  bool result = false;
  for (const int face : folded(positions)) {
    const Eigen::RowVector3i corners = pairs_.corners(face);
    for (const bool complete_ones : {false, true}) {
      bool more = false;
      for (int k = 0; k < 3; ++k) more = hold_place(corners[k], complete_ones) || more;
      result = result || more;
      if (more) break;
    }
  }
  return result;
}

bool HeldOrbits::hold_more(const Points& positions, bool whole_regions, const RunContext& context) {
  const std::vector<std::vector<char>> wanted = open_places();
  const std::vector<SurfaceMatch> matches = pairs_.match(positions, &wanted, context);
  const std::vector<GapSummary> after = summarised(pairs_, matches);
  bool worse = false;
  bool held_any = false;
  std::size_t pair = 0;
  for (std::size_t r = 0; r < after.size(); ++r) {
    const std::size_t end = pair + after[r].pairs;
    const double slack = rounding_ * (2 * std::sqrt(before_[r].squares * static_cast<double>(after[r].pairs)) +
                                      rounding_ * static_cast<double>(after[r].pairs));
    const bool larger_mean = after[r].squares > before_[r].squares + slack;
    const bool larger_max = after[r].max > before_[r].max + rounding_;
    if (!larger_mean && !larger_max) {
      pair = end;
      continue;
    }
    worse = true;
    if (whole_regions) {
      for (const Probe& probe : pairs_.demands()[r].probes) held_any = hold_place(probe.place, true) || held_any;
      pair = end;
      continue;
    }
    // What maps onto vertices gives way only where what does not has done so already.
    bool more = false;
    for (const bool complete_ones : {false, true}) {
      for (std::size_t p = pair; p < end; ++p) {
        const double limit = larger_mean ? at_rest_[p].distance : before_[r].max;
        if (matches[p].distance > limit + rounding_ / 2) more = hold(p, matches[p], complete_ones) || more;
      }
      if (more) break;
    }
    // Where normals tell a thin part's sides apart otherwise than at rest, the nearest point may be another one.
    if (!more) {
      for (std::size_t p = pair; p < end; ++p) more = hold_place(pairs_[p].place, true) || more;
    }
    held_any = held_any || more;
    pair = end;
  }
  if (worse && !held_any) std::ranges::fill(held_, 1);
  return worse;
}

bool HeldOrbits::hold(std::size_t pair, const SurfaceMatch& match, bool complete_ones) {
  const bool own = hold_place(pairs_[pair].place, complete_ones);
  const bool now = hold_corners(match, complete_ones);
  const bool then = hold_corners(at_rest_[pair], complete_ones);
  return own || now || then;
}

bool HeldOrbits::hold_corners(const SurfaceMatch& match, bool complete_ones) {
  bool result = false;
  if (match.face < 0) return result;
  const Eigen::RowVector3i corners = pairs_.corners(match.face);
  for (int k = 0; k < 3; ++k) {
    if (match.weights[k] > kAside) result = hold_place(corners[k], complete_ones) || result;
  }
  return result;
}

bool HeldOrbits::hold_place(int place, bool complete_ones) {
  const auto orbit = static_cast<std::size_t>(orbit_of_[static_cast<std::size_t>(place)]);
  if (held_[orbit] != 0 || (orbits_[orbit].complete && !complete_ones)) return false;
  held_[orbit] = 1;
  return true;
}

}  // namespace orbifit

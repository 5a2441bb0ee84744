#include "symmetry/orbit.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <unordered_map>

#include "orbifit/model/errors.h"

#include "base/dense.h"

namespace orbifit {

namespace {

constexpr std::size_t kFewPoints = 48;
constexpr double kTurnOfOneRadian = 1;

// Finds points closer than the doublet distance: few are searched one by one; many by cells many times as wide as
// that distance, so that neighbours mostly lie in one. Of points of other places, as where parts touch, none is meant:
// those of the very same places come first, then those that lack some or have others besides.
class Doublets {
 public:
  Doublets(double distance, const std::vector<OrbitPoint>& points, const RegionMap& regions)
      : distance_(distance), points_(points), regions_(regions) {}

  int find(const Eigen::Vector3d& position, int set) {
    double best_distance = distance_;
    bool best_same = false;
    int best = -1;
    const auto consider = [&](int index) {
      const OrbitPoint& point = points_[static_cast<std::size_t>(index)];
      const double d = (point.position - position).norm();
      if (d > distance_) return;
      const bool same = point.set == set;
      if (best_same && !same) return;
      const bool nearer = d < best_distance || (d == best_distance && index < best);
      if (!nearer && same == best_same) return;
      if (!same && !regions_.comparable(point.set, set)) return;
      best = index;
      best_distance = d;
      best_same = same;
    };
    if (points_.size() <= kFewPoints) {
      for (std::size_t k = 0; k < points_.size(); ++k) consider(static_cast<int>(k));
      return best;
    }
    for (; filed_ < points_.size(); ++filed_) {
      cells_.emplace(hash(cell_of(points_[filed_].position)), static_cast<int>(filed_));
    }
    const Eigen::Vector3d reach = Eigen::Vector3d::Constant(1.01 * distance_);
    const Eigen::Vector3d low = cell_of(position - reach);
    const Eigen::Vector3i more = (cell_of(position + reach) - low).cast<int>();
    for (int x = 0; x <= more[0]; ++x) {
      for (int y = 0; y <= more[1]; ++y) {
        for (int z = 0; z <= more[2]; ++z) {
          const auto [begin, end] = cells_.equal_range(hash(low + Eigen::Vector3d(x, y, z)));
          for (auto entry = begin; entry != end; ++entry) consider(entry->second);
        }
      }
    }
    return best;
  }

 private:
  Eigen::Vector3d cell_of(const Eigen::Vector3d& position) const {
    constexpr double kWidth = 20;  // of the distance
    return (position / (kWidth * distance_)).array().floor();
  }

  static std::size_t hash(const Eigen::Vector3d& cell) {
    std::size_t value = 0;
    for (int k = 0; k < 3; ++k) {
      const double coordinate = cell[k] + 0.0;  // -0 and 0 are one cell
      value = value * 0x9e3779b97f4a7c15ULL ^ std::hash<double>{}(coordinate);
    }
    return value;
  }

  double distance_;
  const std::vector<OrbitPoint>& points_;
  const RegionMap& regions_;
  std::size_t filed_ = 0;
  std::unordered_multimap<std::size_t, int> cells_;
};

class Closure {
 public:
  Closure(const RegionMap& regions, GroupWords& words, const ClosureOptions& options)
      : regions_(regions), words_(words), options_(options), doublets_(options.doublet, orbit_.points, regions) {}

  Orbit run(const Eigen::Vector3d& seed, int set) {
    seed_ = seed;
    OrbitPoint first{seed, 0, set};
    const int place = continuous_place(set);
    if (place >= 0) {
      const Continuum& continuum = *regions_.continuum(place);
      orbit_.turn = continuum.turn_to(seed);
      orbit_.turned_by = place;
      first.position = foot_where_near(inverse(orbit_.turn)(seed), continuum);
    }
    add(first, 0);
    for (std::size_t head = 0; head < queue_.size(); ++head) {
      if (options_.context != nullptr) options_.context->check();
      expand(queue_[head]);
    }
    return std::move(orbit_);
  }

 private:
  // The place whose continuum decides where points of the set are canonical; -1 for none.
  int continuous_place(int set) const {
    int chosen = -1;
    for (const int place : regions_.set_places(set)) {
      const Continuum* continuum = regions_.continuum(place);
      if (continuum == nullptr) continue;
      if (chosen < 0) {
        chosen = place;
        continue;
      }
      const Continuum& other = *regions_.continuum(chosen);
      const double scale = 1e-6 * (1 + (continuum->centre - other.centre).norm());
      if (continuum->spherical && other.spherical) {
        if ((continuum->centre - other.centre).norm() > scale) refuse(place, chosen);
      } else if (continuum->spherical || other.spherical) {
        const Continuum& sphere = continuum->spherical ? *continuum : other;
        const Continuum& line = continuum->spherical ? other : *continuum;
        if (line.distance(sphere.centre) > scale) refuse(place, chosen);
        if (continuum->spherical) chosen = place;
      } else if (continuum->axis.cross(other.axis).norm() > 1e-6 || continuum->distance(other.centre) > scale) {
        refuse(place, chosen);
      }
    }
    return chosen;
  }

  [[noreturn]] void refuse(int a, int b) const {
    throw InputError("", "regions \"" + regions_.name(a) + "\" and \"" + regions_.name(b) + "\"",
                     "together they carry a point to more than " + std::to_string(options_.most_points) +
                         " places: their groups do not close; drop or correct one of them");
  }

  // On the axis exactly, where it is nearly.
  Eigen::Vector3d foot_where_near(const Eigen::Vector3d& position, const Continuum& continuum) const {
    return continuum.distance(position) < options_.doublet ? continuum.foot(position) : position;
  }

  void add(const OrbitPoint& point, int closed_set) {
    const int index = static_cast<int>(orbit_.points.size());
    orbit_.points.push_back(point);
    closed_.push_back(closed_set);
    queue_.push_back(index);
    const int place = continuous_place(point.set);
    if (place >= 0) restrict_to_continuum(index, place);
  }

  // What the rotations that fix a canonical place demand of it.
  void restrict_to_continuum(int index, int place) {
    const Continuum& continuum = *regions_.continuum(place);
    const OrbitPoint point = orbit_.points[static_cast<std::size_t>(index)];
    const bool centred = continuum.distance(point.position) < options_.doublet;  // on the axis, but for rounding
    const auto demand = [&](const Eigen::Vector3d& axis) {
      const Motion turn = Motion::rotation(axis, kTurnOfOneRadian, continuum.centre);
      orbit_.constraints.push_back({index, words_.extended(point.word, place, -1, turn)});
    };
    if (centred || continuum.spherical) demand(continuum.axis);
    if (centred && continuum.spherical) demand(continuum.reference);
    for (const int other : regions_.set_places(point.set)) {
      if (other == place || regions_.continuum(other) == nullptr) continue;
      // To turn by one region and back by the other must do nothing: their axes are carried together.
      const Continuum& second = *regions_.continuum(other);
      const auto turn_and_back = [&](const Eigen::Vector3d& axis) {
        const Motion turn = Motion::rotation(axis, kTurnOfOneRadian, second.centre);
        const int there = words_.extended(point.word, place, -1, turn);
        const int back = words_.extended(there, other, -1, inverse(turn));
        if (!words_.same(point.word, back)) orbit_.constraints.push_back({index, back});
      };
      turn_and_back(second.axis);
      if (second.spherical) turn_and_back(second.reference);
    }
  }

  void expand(int at) {
    for (std::size_t r = 0; r < regions_.set_places(set_of(at)).size(); ++r) {
      const int place = regions_.set_places(set_of(at))[r];
      if (regions_.holds(closed_[static_cast<std::size_t>(at)], place)) continue;
      const std::vector<Motion>& elements = regions_.elements(place);
      for (std::size_t e = 0; e < elements.size(); ++e) {
        arrive(at, place, static_cast<int>(e), elements[e]);
      }
      last_place_ = place;
    }
  }

  void arrive(int at, int place, int element, const Motion& motion) {
    const OrbitPoint from = orbit_.points[static_cast<std::size_t>(at)];
    const int arrival = regions_.arrival(place, element);
    const Eigen::Vector3d image = motion(from.position);
    const int image_word = words_.extended(from.word, place, element, motion);
    const int carried = regions_.carried_set(from.set, place, element);
    Eigen::Vector3d position = image;
    int word = image_word;
    // Points are compared at their canonical places: on a circle two may be near one another and differ by a turn.
    const auto turn_back = [&](int turning) {
      if (turning < 0) return;
      const Continuum& continuum = *regions_.continuum(turning);
      const Motion back = inverse(continuum.turn_to(image));
      position = foot_where_near(back(image), continuum);
      word = words_.extended(image_word, turning, -1, back);
    };
    int set = carried;
    turn_back(continuous_place(set));
    int known = doublets_.find(position, set);
    if (known < 0) {
      set = set_at(image, carried);
      if (continuous_place(set) != continuous_place(carried)) turn_back(continuous_place(set));
      if (set != carried) known = doublets_.find(position, set);
    }
    note_stabiliser(known, word, set);
    if (known >= 0) {
      meet(known, word, arrival, carried);
    } else {
      if (static_cast<int>(orbit_.points.size()) >= options_.most_points) {
        refuse(place, last_place_ < 0 ? place : last_place_);
      }
      known = static_cast<int>(orbit_.points.size());
      add({position, word, set}, regions_.with(0, arrival));
    }
    turn_alike(from, place, element, motion, known);
  }

  // To go by a word to where the seed is keeps it, or nearly; so does to go and come back by that of the known point it
  // arrives at. Both are looked at: of several points that near one another, which is met depends on their order. A
  // point of other places that merely lies there is another one.
  void note_stabiliser(int known, int word, int set) {
    if (!(options_.snap > 0)) return;
    const Motion& way = words_.motion(word);
    if (regions_.comparable(set, set_of(0))) note_if_near(way);
    if (known > 0) note_if_near(inverse(words_.motion(orbit_.points[static_cast<std::size_t>(known)].word)) * way);
  }

  void note_if_near(const Motion& loop) {
    const Eigen::Vector3d& start = orbit_.points.front().position;
    if ((loop(start) - start).norm() >= options_.snap) return;
    if ((loop.linear - Eigen::Matrix3d::Identity()).norm() > 1e-7) orbit_.stabilisers.push_back(loop);
  }

  // A motion that takes one continuous group to another: to turn by the one, go, and turn back by the other must be to
  // go. Finite groups have all their elements tried, so that they need no such thing said.
  void turn_alike(const OrbitPoint& from, int place, int element, const Motion& motion, int there) {
    const int here_turning = continuous_place(from.set);
    const int there_turning = continuous_place(orbit_.points[static_cast<std::size_t>(there)].set);
    if (here_turning < 0 || there_turning < 0 || (place == here_turning && place == there_turning)) return;
    const Continuum& here = *regions_.continuum(here_turning);
    const Continuum& other = *regions_.continuum(there_turning);
    if (here.spherical != other.spherical) return;
    const auto demand = [&](const Eigen::Vector3d& axis, const Eigen::Vector3d& other_axis) {
      const Eigen::Vector3d taken = motion.linear.determinant() * motion.linear * axis;
      const double angle = taken.dot(other_axis) < 0 ? -kTurnOfOneRadian : kTurnOfOneRadian;
      int word = words_.extended(from.word, here_turning, -1, Motion::rotation(axis, kTurnOfOneRadian, here.centre));
      word = words_.extended(word, place, element, motion);
      word = words_.extended(word, there_turning, -1, Motion::rotation(other_axis, -angle, other.centre));
      const Eigen::Vector3d image = motion(from.position);
      const Motion back = inverse(other.turn_to(image));
      word = words_.extended(word, there_turning, -1, back);
      if (!words_.same(orbit_.points[static_cast<std::size_t>(there)].word, word)) {
        orbit_.constraints.push_back({there, word});
      }
    };
    if (!here.spherical) {
      demand(here.axis, other.axis);
      return;
    }
    for (const Eigen::Vector3d& axis : {here.axis, here.reference}) {
      demand(axis, motion.linear.determinant() * motion.linear * axis);
    }
  }

  // A point that turns out to lie in more places than known has more images.
  void meet(int known, int word, int arrival, int carried) {
    OrbitPoint& point = orbit_.points[static_cast<std::size_t>(known)];
    int& closed = closed_[static_cast<std::size_t>(known)];
    if (!words_.same(point.word, word)) orbit_.constraints.push_back({known, word});
    if (regions_.contains(point.set, carried)) {
      closed = regions_.with(closed, arrival);
      return;
    }
    point.set = regions_.joined(point.set, carried);
    closed = 0;
    queue_.push_back(known);
  }

  int set_of(int point) const { return orbit_.points[static_cast<std::size_t>(point)].set; }

  // The motion carries the point's places along; where a known point is, it may know of more.
  int set_at(const Eigen::Vector3d& position, int carried) const {
    const int known = options_.set_at ? options_.set_at(position, carried) : -1;
    return known >= 0 ? known : carried;
  }

  const RegionMap& regions_;
  GroupWords& words_;
  const ClosureOptions& options_;
  Orbit orbit_;
  Doublets doublets_;
  std::vector<int> closed_;  // sets of places whose motions have been applied from the point or its images
  std::vector<int> queue_;
  Eigen::Vector3d seed_ = Eigen::Vector3d::Zero();
  int last_place_ = -1;
};

}  // namespace

Orbit orbit_of(const Eigen::Vector3d& seed, int set, const RegionMap& regions, GroupWords& words,
               const ClosureOptions& options) {
  return Closure(regions, words, options).run(seed, set);
}

Orbit snapped_orbit_of(const Eigen::Vector3d& seed, int set, const RegionMap& regions, GroupWords& words,
                       const ClosureOptions& options) {
  constexpr double kMax = 10;  // doublet distances: motions without a common fixed point do not pull the seed away
  ClosureOptions snapping = options;
  snapping.snap = options.doublet;
  Orbit orbit = orbit_of(seed, set, regions, words, snapping);
  if (orbit.stabilisers.empty()) return orbit;
  const Eigen::Vector3d start = orbit.points.front().position;
  const Eigen::Vector3d fixed = fixed_point(start, orbit.stabilisers);
  if (fixed == start || (fixed - start).norm() > kMax * options.doublet) return orbit;
  const Eigen::Vector3d snapped = orbit.turned_by < 0 ? fixed : orbit.turn(fixed);
  return orbit_of(snapped, orbit.points.front().set, regions, words, options);
}

Eigen::Vector3d fixed_point(const Eigen::Vector3d& seed, const std::vector<Motion>& stabilisers) {
  if (stabilisers.empty()) return seed;
  Eigen::MatrixXd system(3 * static_cast<Eigen::Index>(stabilisers.size()), 3);
  Eigen::VectorXd moved(system.rows());
  for (std::size_t i = 0; i < stabilisers.size(); ++i) {
    const auto row = 3 * static_cast<Eigen::Index>(i);
    system.middleRows<3>(row) = stabilisers[i].linear - Eigen::Matrix3d::Identity();
    moved.segment<3>(row) = seed - stabilisers[i](seed);
  }
  return seed + shortest_solution(system, moved, 1e-6);
}

}  // namespace orbifit

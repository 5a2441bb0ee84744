#include "rest_shape/matched_orbits.h"

#include <algorithm>
#include <numeric>

#include "base/dense.h"

namespace orbifit {

namespace {

// Linear parts that differ by less are meant to be the same: a fifth of the finest rotation, by 2 pi / 256.
constexpr double kAlike = 5e-3;
// What two ways to one place may differ by, relative to the diagonal: rounding, also of long ways.
constexpr double kExact = 1e-12;
// The same, relative to the coordinates.
constexpr double kMatchRounding = 1e-14;
// Members that come nearer to one another fall together, relative to the diagonal.
constexpr double kTogether = 1e-10;

bool alike(const Motion& a, const Motion& b) {
  return (a.linear - b.linear).cwiseAbs().maxCoeff() < kAlike;
}

class OrbitSearch {
 public:
  OrbitSearch(const Places& places, const std::vector<RegionMatching>& regions, double scale, double reach)
      : places_(places),
        regions_(regions),
        scale_(scale),
        exact_(kExact * scale + kMatchRounding * largest_coordinate(places.positions)),
        reach_(reach),
        regions_of_place_(place_count()),
        found_(place_count(), -1) {
    for (std::size_t r = 0; r < regions.size(); ++r) {
      for (std::size_t i = 0; i < regions[r].inside.size(); ++i) {
        regions_of_place_[static_cast<std::size_t>(regions[r].inside[i])].push_back(
            {static_cast<int>(r), static_cast<int>(i)});
      }
    }
  }

  std::vector<PlaceOrbit> run() {
    std::vector<PlaceOrbit> orbits;
    std::vector<char> done(place_count(), 0);
    for (std::size_t p = 0; p < place_count(); ++p) {
      if (done[p] != 0) continue;
      PlaceOrbit orbit = orbit_of_place(static_cast<int>(p), done);
      for (const int member : orbit.members) done[static_cast<std::size_t>(member)] = 1;
      orbits.push_back(std::move(orbit));
    }
    return orbits;
  }

 private:
  struct Membership {
    int region;
    int number;  // among the region's places
  };

  static double largest_coordinate(const Points& positions) {
    return positions.size() == 0 ? 0 : positions.cwiseAbs().maxCoeff();
  }

  std::size_t place_count() const { return static_cast<std::size_t>(places_.positions.rows()); }

  // Leaves regions out until what is left closes; the trivial orbit always does.
  PlaceOrbit orbit_of_place(int seed, const std::vector<char>& done) {
    std::vector<char> followed(regions_.size(), 1);
    bool complete = true;
    bool clashes = false;
    while (true) {
      std::vector<char> failing(regions_.size(), 0);
      PlaceOrbit orbit = walk(seed, followed, done, failing);
      const bool fails = std::ranges::find(failing, 1) != failing.end();
      if (!fails && !orbit.clashes && sound(orbit)) {
        orbit.complete = complete;
        orbit.clashes = clashes;
        return orbit;
      }
      complete = false;
      clashes = clashes || orbit.clashes;
      if (!fails) failing[static_cast<std::size_t>(last_followed(orbit, followed))] = 1;
      for (std::size_t r = 0; r < regions_.size(); ++r) {
        if (failing[r] != 0) followed[r] = 0;
      }
    }
  }

  // The last of the regions that made the orbit: annotations list the more important ones first.
  int last_followed(const PlaceOrbit& orbit, const std::vector<char>& followed) const {
    int last = 0;
    for (const int member : orbit.members) {
      for (const Membership& membership : regions_of_place_[static_cast<std::size_t>(member)]) {
        if (followed[static_cast<std::size_t>(membership.region)] != 0) last = std::max(last, membership.region);
      }
    }
    return last;
  }

  PlaceOrbit walk(int seed, const std::vector<char>& followed, const std::vector<char>& done,
                  std::vector<char>& failing) {
    PlaceOrbit orbit;
    orbit.members.push_back(seed);
    orbit.motions.emplace_back();
    found_[static_cast<std::size_t>(seed)] = 0;
    for (std::size_t at = 0; at < orbit.members.size(); ++at) {
      for (const Membership& membership : regions_of_place_[static_cast<std::size_t>(orbit.members[at])]) {
        const auto r = static_cast<std::size_t>(membership.region);
        if (followed[r] == 0) continue;
        for (std::size_t g = 0; g < regions_[r].generators.size(); ++g) {
          const int image = regions_[r].matches[g][static_cast<std::size_t>(membership.number)];
          if (image < 0) {
            failing[r] = 1;
            continue;
          }
          const int place = regions_[r].inside[static_cast<std::size_t>(image)];
          if (done[static_cast<std::size_t>(place)] != 0) {  // of an orbit that could not follow all regions
            failing[r] = 1;
            continue;
          }
          visit(orbit, place, regions_[r].generators[g] * orbit.motions[at]);
        }
      }
    }
    for (const int member : orbit.members) found_[static_cast<std::size_t>(member)] = -1;
    return orbit;
  }

  void visit(PlaceOrbit& orbit, int place, const Motion& motion) {
    int& found = found_[static_cast<std::size_t>(place)];
    if (found < 0) {
      found = static_cast<int>(orbit.members.size());
      orbit.members.push_back(place);
      orbit.motions.push_back(motion);
      return;
    }
    const Motion& known = orbit.motions[static_cast<std::size_t>(found)];
    const Eigen::Vector3d seed = places_.positions.row(orbit.members.front());
    if (alike(known, motion)) {
      orbit.clashes = orbit.clashes || (known(seed) - motion(seed)).norm() > exact_;
      return;
    }
    const Motion stabiliser = inverse(known) * motion;
    for (const Motion& other : orbit.stabilisers) {
      if (!alike(other, stabiliser)) continue;
      orbit.clashes = orbit.clashes || (other(seed) - stabiliser(seed)).norm() > exact_;
      return;
    }
    orbit.stabilisers.push_back(stabiliser);
  }

  // Whether the stabilisers have a fixed point, no two members fall together and none goes far.
  bool sound(const PlaceOrbit& orbit) const {
    const Eigen::Vector3d first = orbit_mean(orbit, places_.positions);
    for (const Motion& stabiliser : orbit.stabilisers) {
      if ((stabiliser(first) - first).norm() > exact_) return false;
    }
    std::vector<Eigen::Vector3d> targets;
    targets.reserve(orbit.motions.size());
    for (std::size_t k = 0; k < orbit.members.size(); ++k) {
      targets.push_back(orbit.motions[k](first));
      if ((targets.back() - places_.positions.row(orbit.members[k]).transpose()).norm() > reach_) return false;
    }
    std::ranges::sort(targets, {}, [](const Eigen::Vector3d& target) { return target.x(); });
    for (std::size_t i = 0; i < targets.size(); ++i) {
      for (std::size_t j = i + 1; j < targets.size() && targets[j].x() - targets[i].x() < kTogether * scale_; ++j) {
        if ((targets[j] - targets[i]).norm() < kTogether * scale_) return false;
      }
    }
    return true;
  }

  const Places& places_;
  const std::vector<RegionMatching>& regions_;
  double scale_;
  double exact_;  // mesh units
  double reach_;
  std::vector<std::vector<Membership>> regions_of_place_;
  std::vector<int> found_;  // number within the orbit being walked
};

}  // namespace

std::vector<PlaceOrbit> matched_orbits(const Places& places, const std::vector<RegionMatching>& regions, double scale,
                                       double reach) {
  return OrbitSearch(places, regions, scale, reach).run();
}

Eigen::Vector3d stabilised(const PlaceOrbit& orbit, const Eigen::Vector3d& point) {
  if (orbit.stabilisers.empty()) return point;
  Eigen::MatrixXd system(3 * static_cast<Eigen::Index>(orbit.stabilisers.size()), 3);
  Eigen::VectorXd moved(system.rows());
  for (std::size_t i = 0; i < orbit.stabilisers.size(); ++i) {
    const auto row = 3 * static_cast<Eigen::Index>(i);
    system.middleRows<3>(row) = orbit.stabilisers[i].linear - Eigen::Matrix3d::Identity();
    moved.segment<3>(row) = point - orbit.stabilisers[i](point);
  }
  return point + shortest_solution(system, moved, 1e-3);
}

Eigen::Matrix3d free_directions(const PlaceOrbit& orbit) {
  constexpr double kFree = 1e-6;  // squared: the finest rotation's is 6e-4
  Eigen::Matrix3d moved = Eigen::Matrix3d::Zero();
  for (const Motion& stabiliser : orbit.stabilisers) {
    const Eigen::Matrix3d off = stabiliser.linear - Eigen::Matrix3d::Identity();
    moved += off.transpose() * off;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> directions(moved);
  Eigen::Matrix3d result = Eigen::Matrix3d::Zero();
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d direction = directions.eigenvectors().col(k);
    if (directions.eigenvalues()[k] < kFree) result += direction * direction.transpose();
  }
  return result;
}

Eigen::Vector3d orbit_mean(const PlaceOrbit& orbit, const Points& positions) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < orbit.members.size(); ++k) {
    sum += inverse(orbit.motions[k])(positions.row(orbit.members[k]).transpose());
  }
  return stabilised(orbit, sum / static_cast<double>(orbit.members.size()));
}

}  // namespace orbifit

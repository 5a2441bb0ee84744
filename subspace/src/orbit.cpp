#include "orbifit/subspace/orbit.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <unordered_map>

#include <Eigen/SVD>

#include "orbifit/model/errors.h"

namespace orbifit {

namespace {

void add_carried(Transport& transport, int region, const Eigen::Matrix3d& matrix) {
  const auto place =
      std::ranges::lower_bound(transport.carried, region, {}, [](const auto& part) { return part.first; });
  if (place != transport.carried.end() && place->first == region) {
    place->second += matrix;
  } else {
    transport.carried.insert(place, {region, matrix});
  }
}

// Finds points closer than the doublet distance: cells as wide as that distance, so neighbours lie in 27 cells.
class DoubletGrid {
 public:
  explicit DoubletGrid(double distance) : distance_(distance) {}

  int find(const Eigen::Vector3d& position, const std::vector<OrbitPoint>& points) const {
    const Eigen::Vector3d cell = (position / distance_).array().floor();
    int best = -1;
    double best_distance = distance_;
    for (int k = 0; k < 27; ++k) {
      const Eigen::Vector3d step(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
      const auto [begin, end] = cells_.equal_range(hash(cell + step));
      for (auto entry = begin; entry != end; ++entry) {
        const double d = (points[static_cast<std::size_t>(entry->second)].position - position).norm();
        if (d < best_distance || (d == best_distance && entry->second < best)) {
          best = entry->second;
          best_distance = d;
        }
      }
    }
    return best;
  }

  void insert(const Eigen::Vector3d& position, int index) {
    cells_.emplace(hash((position / distance_).array().floor()), index);
  }

 private:
  static std::size_t hash(const Eigen::Vector3d& cell) {
    std::size_t value = 0;
    for (int k = 0; k < 3; ++k) {
      const double coordinate = cell[k] + 0.0;  // -0 and 0 are one cell
      value = value * 0x9e3779b97f4a7c15ULL ^ std::hash<double>{}(coordinate);
    }
    return value;
  }

  double distance_;
  std::unordered_multimap<std::size_t, int> cells_;
};

}  // namespace

Transport transported(const Transport& from, const Eigen::Matrix3d& linear, int region, bool floating) {
  Transport result;
  result.frame = linear * from.frame;
  if (!floating) return result;
  result.carried.reserve(from.carried.size() + 1);
  for (const auto& [other, matrix] : from.carried) result.carried.emplace_back(other, linear * matrix);
  add_carried(result, region, Eigen::Matrix3d::Identity() - linear);
  return result;
}

double transport_difference(const Transport& a, const Transport& b) {
  double result = (a.frame - b.frame).cwiseAbs().maxCoeff();
  auto i = a.carried.begin();
  auto j = b.carried.begin();
  while (i != a.carried.end() || j != b.carried.end()) {
    const bool take_a = j == b.carried.end() || (i != a.carried.end() && i->first <= j->first);
    const bool take_b = i == a.carried.end() || (j != b.carried.end() && j->first <= i->first);
    Eigen::Matrix3d difference = Eigen::Matrix3d::Zero();
    if (take_a) difference += (i++)->second;
    if (take_b) difference -= (j++)->second;
    result = std::max(result, difference.cwiseAbs().maxCoeff());
  }
  return result;
}

Orbit orbit_of(const Eigen::Vector3d& seed, int face, const RegionMap& regions, const ClosureOptions& options) {
  // Two ways to one point give the same transport up to rounding unless they restrict the displacement.
  constexpr double kSameTransport = 1e-7;
  Orbit orbit;
  DoubletGrid grid(options.doublet);
  std::vector<std::vector<int>> closed{{}};  // regions whose whole group has been applied from the point or its images
  orbit.points.push_back({seed, Motion{}, Transport{}, regions.regions_of_face(face)});
  grid.insert(seed, 0);
  const auto holds = [](const std::vector<int>& list, int region) { return std::ranges::binary_search(list, region); };
  const auto insert = [](std::vector<int>& list, int region) {
    const auto place = std::ranges::lower_bound(list, region);
    if (place == list.end() || *place != region) list.insert(place, region);
  };

  std::vector<int> queue{0};
  int previous_region = -1;
  for (std::size_t head = 0; head < queue.size(); ++head) {
    const int at = queue[head];
    for (std::size_t r = 0; r < orbit.points[static_cast<std::size_t>(at)].regions.size(); ++r) {
      const int region = orbit.points[static_cast<std::size_t>(at)].regions[r];
      if (holds(closed[static_cast<std::size_t>(at)], region)) continue;
      if (options.followed != nullptr && (*options.followed)[static_cast<std::size_t>(region)] == 0) continue;
      for (const Motion& element : regions.elements(region)) {
        const OrbitPoint& from = orbit.points[static_cast<std::size_t>(at)];
        const Eigen::Vector3d position = element(from.position);
        Transport transport = transported(from.transport, element.linear, region, options.floating);
        const Motion motion = element * from.motion;
        const int known = grid.find(position, orbit.points);
        if (options.snap > 0 && (motion(seed) - seed).norm() < options.snap &&
            (motion.linear - Eigen::Matrix3d::Identity()).norm() > kSameTransport) {
          orbit.stabilisers.push_back(motion);
        }
        if (known >= 0) {
          OrbitPoint& point = orbit.points[static_cast<std::size_t>(known)];
          if (transport_difference(point.transport, transport) > kSameTransport) {
            orbit.constraints.push_back({known, std::move(transport)});
          }
          if (!holds(point.regions, region)) {
            for (const int near : regions.regions_near(position, region)) insert(point.regions, near);
            queue.push_back(known);
          }
          insert(closed[static_cast<std::size_t>(known)], region);
          continue;
        }
        const int index = static_cast<int>(orbit.points.size());
        if (index >= options.most_points) {
          throw InputError("",
                           "regions \"" + regions.name(region) + "\" and \"" +
                               regions.name(previous_region < 0 ? region : previous_region) + "\"",
                           "together they carry a point to more than " + std::to_string(options.most_points) +
                               " places: their groups do not close; drop or correct one of them");
        }
        orbit.points.push_back({position, motion, std::move(transport), regions.regions_near(position, region)});
        closed.push_back({region});
        grid.insert(position, index);
        queue.push_back(index);
      }
      previous_region = region;
    }
  }
  return orbit;
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
  Eigen::JacobiSVD<Eigen::MatrixXd> svd(system, Eigen::ComputeThinU | Eigen::ComputeThinV);
  svd.setThreshold(1e-6);
  return seed + svd.solve(moved);
}

}  // namespace orbifit

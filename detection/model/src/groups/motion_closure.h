#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "orbifit/model/motion.h"

namespace orbifit {

/// The part of space on which motions are compared, mesh units.
struct Extent {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double reach = 0;  ///< > 0
};

/// Elements at most of a group that motions make: one that has more does not close.
inline constexpr std::size_t kMaxStabilisers = 120;

/// How far two motions are apart on a shape, mesh units.
inline double distance(const Motion& a, const Motion& b, const Extent& extent) {
  return motion_distance(a, b, extent.centre, extent.reach);
}

/// All products of the generators, the identity first, as far as they are few. Those nearer than `same` are one.
inline std::vector<Motion> closure(const std::vector<Motion>& generators, const Extent& extent, double same) {
  std::vector<Motion> result{Motion{}};
  for (std::size_t head = 0; head < result.size() && result.size() < kMaxStabilisers; ++head) {
    for (const Motion& generator : generators) {
      const Motion product = generator * result[head];
      if (std::ranges::none_of(result, [&](const Motion& m) { return distance(m, product, extent) <= same; })) {
        result.push_back(product);
      }
    }
  }
  return result;
}

}  // namespace orbifit

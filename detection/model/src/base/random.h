#pragma once

#include <cstdint>
#include <string_view>

#include <Eigen/Core>

namespace orbifit {

/// A stream of pseudo-random numbers (xoshiro256**, Blackman and Vigna 2018) whose values do not depend on the
/// standard library. Streams of the same seed with different names are independent.
class Random {
 public:
  explicit Random(std::uint64_t seed, std::string_view stream = {});

  std::uint64_t next();
  double uniform();                          ///< in [0, 1)
  double uniform(double low, double high);   ///< in [low, high)
  std::uint64_t below(std::uint64_t bound);  ///< in [0, bound), bound >= 1
  double normal();                           ///< mean 0, variance 1
  Eigen::Vector3d direction();               ///< uniform on the unit sphere
  Eigen::Matrix3d rotation();                ///< uniform on SO(3)

 private:
  std::uint64_t state_[4];
};

}  // namespace orbifit

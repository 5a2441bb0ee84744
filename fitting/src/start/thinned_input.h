#pragma once

#include <cstdint>
#include <vector>

#include "orbifit/fitting/fit.h"

namespace orbifit {

/// A fit's input with no more than so many points of each scan (thinned_scan.h).
class ThinnedInput {
 public:
  /// What the input refers to is kept by reference.
  ThinnedInput(const FitInput& input, int most, std::uint64_t seed);
  ThinnedInput(const ThinnedInput&) = delete;
  ThinnedInput& operator=(const ThinnedInput&) = delete;
  ThinnedInput(ThinnedInput&&) = delete;
  ThinnedInput& operator=(ThinnedInput&&) = delete;
  ~ThinnedInput() = default;

  const FitInput& input() const { return input_; }

 private:
  PointCloud scan_;
  std::vector<PointCloud> others_;
  FitInput input_;
};

}  // namespace orbifit

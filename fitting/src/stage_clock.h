#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "orbifit/fitting/fit.h"

namespace orbifit {

/// Notes how long one stage after the other took.
class StageClock {
 public:
  /// \param times  kept by reference: where the stages are noted
  explicit StageClock(std::vector<StageTime>& times) : times_(times) {}

  /// The stage that began when the one before it was finished.
  void finished(const std::string& stage) {
    const auto now = std::chrono::steady_clock::now();
    times_.push_back({stage, std::chrono::duration<double>(now - last_).count()});
    last_ = now;
  }

 private:
  std::vector<StageTime>& times_;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace orbifit

#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "orbifit/fitting/fit.h"

namespace orbifit {

/// Seconds since it was made, or since it was last set back.
class Stopwatch {
 public:
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }
  void set_back() { start_ = std::chrono::steady_clock::now(); }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Notes how long one stage after the other took.
class StageClock {
 public:
  /// \param times  kept by reference: where the stages are noted
  explicit StageClock(std::vector<StageTime>& times) : times_(times) {}

  /// The stage that began when the one before it was finished.
  void finished(const std::string& stage) {
    times_.push_back({stage, since_.seconds()});
    since_.set_back();
  }

 private:
  std::vector<StageTime>& times_;
  Stopwatch since_;
};

}  // namespace orbifit

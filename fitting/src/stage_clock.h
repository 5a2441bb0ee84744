#pragma once

#include <algorithm>
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
    times_.push_back({stage, std::max(0.0, since_.seconds() - beside_)});
    beside_ = 0;
    since_.set_back();
  }

  /// A stage beside which the one that is finished next went on: that one is the less.
  void took(const std::string& stage, double seconds) {
    times_.push_back({stage, seconds});
    beside_ += seconds;
  }

 private:
  std::vector<StageTime>& times_;
  Stopwatch since_;
  double beside_ = 0;  // seconds noted since then
};

}  // namespace orbifit

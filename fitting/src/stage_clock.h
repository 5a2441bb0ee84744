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
  void finished(const std::string& stage) { finished(stage, 0); }

  /// The same, but so many seconds were another stage's, beside which it went on, and which is finished next.
  void finished(const std::string& stage, double beside) {
    times_.push_back({stage, std::max(0.0, since_.seconds() + left_ - beside)});
    left_ = beside;
    since_.set_back();
  }

 private:
  std::vector<StageTime>& times_;
  Stopwatch since_;
  double left_ = 0;  // seconds of the next stage before that
};

}  // namespace orbifit

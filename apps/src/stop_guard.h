#pragma once

#include <chrono>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>

#include "orbifit/model/run_context.h"

namespace orbifit {

/// Why a run is to stop.
enum class StopReason { interrupted, timeout };

/// Ends the program where the work has not ended by itself kGrace after a signal or the deadline: what asks the
/// RunContext ends in order, but a factorisation within a library does not ask. A second signal ends it at once.
/// Files that are being written are removed first.
class StopGuard {
 public:
  static constexpr auto kGrace = std::chrono::milliseconds(250);  // half of what people may have to wait

  /// \param run      its deadline; signals are those that interruption() catches
  /// \param last     says why, on a thread of its own while the work goes on; returns the exit code
  StopGuard(const RunContext& run, std::function<int(StopReason)> last);
  ~StopGuard();  ///< The work is over.
  StopGuard(const StopGuard&) = delete;
  StopGuard& operator=(const StopGuard&) = delete;
  StopGuard(StopGuard&&) = delete;
  StopGuard& operator=(StopGuard&&) = delete;

 private:
  using Clock = std::chrono::steady_clock;

  void watch();
  std::optional<StopReason> reason() const;
  bool over();

  std::optional<Clock::time_point> deadline_;
  std::function<int(StopReason)> last_;
  std::mutex mutex_;
  bool over_ = false;
  std::thread thread_;  // none where the system has no more: the work is asked to stop all the same
};

}  // namespace orbifit

#pragma once

#include <atomic>
#include <chrono>
#include <optional>

namespace orbifit {

/// Set by the first SIGINT or SIGTERM. A second one ends the program at once: by a StopGuard where one watches, else as
/// the system does.
const std::atomic<bool>& interruption();

/// What a StopGuard has to do with the signals that interruption() catches.
struct Interruption {
  static int count();                     ///< of signals so far
  static void set_guarded(bool guarded);  ///< whether somebody waits for signals
  static void wake();                     ///< wait() returns
  /// Until a signal, wake(), the time given, or for no reason.
  static void wait(std::optional<std::chrono::steady_clock::time_point> longest);
};

}  // namespace orbifit

#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>

namespace orbifit {

/// What a stage may know about the run: seed, threads, when to stop, whom to tell. There is no global state.
struct RunContext {
  std::uint64_t seed = 1;  ///< the same input and seed give the same bytes, with any number of threads
  int threads = 1;         ///< >= 1

  std::optional<std::chrono::steady_clock::time_point> deadline;
  const std::atomic<bool>* interrupted = nullptr;  ///< set from a signal handler; not owned

  std::function<void(std::string_view stage, double fraction)> on_progress;  ///< fraction in [0, 1]
  std::function<void(std::string_view message)> on_message;                  ///< one line, without line break

  /// \throw TimeoutError, InterruptedError
  void check() const;

  /// check(), then tell how far the stage is.
  void progress(std::string_view stage, double fraction) const;

  void message(std::string_view text) const;
};

/// Calls body(begin, end) on contiguous chunks of [0, count), on as many of context.threads threads as are idle.
/// Chunks depend on count alone and are begun in their order, so a body that writes only to its own indices gives the
/// same result with any number of threads. Loops within a body share the threads.
/// An exception of a body is rethrown here, the one of the lowest chunk first.
/// \pre no lock is held that a body of this or another loop takes: a thread that waits for others runs such bodies
/// \param least_share  the fewest items worth a thread of their own, which takes some ten microseconds to begin
void parallel_for(const RunContext& context, std::size_t count,
                  const std::function<void(std::size_t begin, std::size_t end)>& body, std::size_t least_share = 1);

}  // namespace orbifit

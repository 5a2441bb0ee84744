#include "orbifit/model/run_context.h"

#include <algorithm>
#include <exception>
#include <thread>
#include <vector>

#include "orbifit/model/errors.h"

namespace orbifit {

void RunContext::check() const {
  if (interrupted != nullptr && interrupted->load(std::memory_order_relaxed)) throw InterruptedError("interrupted");
  if (deadline && std::chrono::steady_clock::now() > *deadline) throw TimeoutError("the time allowed has passed");
}

void RunContext::progress(std::string_view stage, double fraction) const {
  check();
  if (on_progress) on_progress(stage, fraction);
}

void RunContext::message(std::string_view text) const {
  if (on_message) on_message(text);
}

void parallel_for(const RunContext& context, std::size_t count,
                  const std::function<void(std::size_t begin, std::size_t end)>& body, std::size_t least_share) {
  constexpr std::size_t kChunks = 64;
  const std::size_t chunks = std::min(count, kChunks);
  const auto bound = [&](std::size_t chunk) { return count * chunk / chunks; };
  const std::size_t worthwhile =
      std::min(chunks, std::max<std::size_t>(1, count / std::max<std::size_t>(1, least_share)));
  const std::size_t threads = std::min(static_cast<std::size_t>(std::max(context.threads, 1)), worthwhile);
  if (threads <= 1) {
    for (std::size_t chunk = 0; chunk < chunks; ++chunk) {
      context.check();
      body(bound(chunk), bound(chunk + 1));
    }
    return;
  }
  std::vector<std::exception_ptr> failures(chunks);
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t chunk = next++; chunk < chunks; chunk = next++) {
      try {
        context.check();
        body(bound(chunk), bound(chunk + 1));
      } catch (...) {  // handed to the caller below
        failures[chunk] = std::current_exception();
        next = chunks;
      }
    }
  };
  {
    std::vector<std::jthread> workers;
    for (std::size_t i = 1; i < threads; ++i) workers.emplace_back(work);
    work();
  }
  for (const std::exception_ptr& failure : failures) {
    if (failure) std::rethrow_exception(failure);
  }
}

}  // namespace orbifit

#include "orbifit/model/run_context.h"

#include <algorithm>
#include <exception>
#include <map>
#include <mutex>
#include <new>
#include <stdexcept>
#include <thread>
#include <vector>

#if !defined(__SANITIZE_THREAD__) && !defined(ORBIFIT_PORTABLE)
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#endif

#include "orbifit/model/errors.h"

namespace orbifit {

namespace {

#if defined(ORBIFIT_PORTABLE)

// One thread does all.
template <class Work>
void run_on(std::size_t /*threads*/, int /*allowed*/, const Work& work) {
  work(0);
}

#elif defined(__SANITIZE_THREAD__)

// The thread sanitizer does not see what TBB's threads wait for, and would report all that they hand to one another.
template <class Work>
void run_on(std::size_t threads, int /*allowed*/, const Work& work) {
  std::vector<std::thread> others;
  for (std::size_t thread = 1; thread < threads; ++thread) others.emplace_back(work, thread);
  work(0);
  for (std::thread& other : others) other.join();
}

#else

// Where loops on so many threads run. Made once: an arena takes a millisecond to get its threads together.
tbb::task_arena& arena_of(int threads) {
  static std::mutex mutex;
  static std::map<int, tbb::task_arena> arenas;
  const std::lock_guard lock(mutex);
  return arenas.try_emplace(threads, threads).first->second;
}

// Runs work(0) ... work(threads - 1), as many at once as are allowed and there are cores.
template <class Work>
void run_on(std::size_t threads, int allowed, const Work& work) {
  const auto loop = [&] { tbb::parallel_for(std::size_t{0}, threads, work, tbb::simple_partitioner{}); };
  // More than there are cores would not be faster, and TBB warns of them.
  const int usable = std::min(allowed, tbb::info::default_concurrency());
  try {
    if (tbb::this_task_arena::max_concurrency() == usable) {
      loop();
    } else {
      arena_of(usable).execute(loop);
    }
  } catch (const std::runtime_error&) {  // not from the work, which keeps what it throws: a thread cannot begin
    throw std::bad_alloc();
  }
}

#endif

}  // namespace

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
  // Each thread takes the lowest chunk that is left, so that what comes first is begun first.
  const auto work = [&](std::size_t) {
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
  run_on(threads, context.threads, work);
  for (const std::exception_ptr& failure : failures) {
    if (failure) std::rethrow_exception(failure);
  }
}

}  // namespace orbifit

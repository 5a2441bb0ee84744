#include "run.h"

#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <string>
#include <thread>

#include "orbifit/model/errors.h"

namespace orbifit::python {

namespace {

using Clock = std::chrono::steady_clock;

// How often signals are looked for: with the time that a stage takes to notice, well below a fifth of a second.
constexpr std::chrono::milliseconds kSignalInterval{20};
// More often nobody sees progress.
constexpr std::chrono::milliseconds kProgressInterval{30};

int threads_of(const RunArguments& arguments) {
  const int threads = arguments.threads.value_or(static_cast<int>(std::max(1U, std::thread::hardware_concurrency())));
  if (threads < 1 || threads > 4096) {
    throw UsageError("threads is " + std::to_string(threads) + "; it must be from 1 to 4096");
  }
  return threads;
}

bool in_main_thread() {
  const py::module_ threading = py::module_::import("threading");
  return threading.attr("current_thread")().is(threading.attr("main_thread")());
}

/// Takes what a stage tells to Python, from whichever thread, and keeps the first exception raised there.
class Listener {
 public:
  Listener(Progress progress, RunContext& context) : progress_(std::move(progress)) {
    context.interrupted = &stop_;
    if (!progress_.is_none()) {
      context.on_progress = [this](std::string_view stage, double fraction) { tell(stage, fraction); };
    }
    context.on_message = [this](std::string_view text) {
      guarded([&] {
        const bool warning = text.starts_with("warning: ");
        if (warning) text.remove_prefix(9);
        py::module_::import("logging").attr("getLogger")("orbifit").attr(warning ? "warning" : "info")("%s", text);
      });
    };
  }

  /// \pre the interpreter's lock is held
  void look_for_signals() {
    if (PyErr_CheckSignals() != 0) keep(py::error_already_set());
  }

  /// Raises what was kept. \pre the interpreter's lock is held
  void raise() {
    if (failure_) throw *failure_;
  }

 private:
  void tell(std::string_view stage, double fraction) {
    {
      const std::lock_guard lock(mutex_);
      const Clock::time_point now = Clock::now();
      if (stage == stage_ && now - told_ < kProgressInterval && fraction < 1) return;
      stage_ = stage;
      told_ = now;
    }
    guarded([&] { progress_(stage, fraction); });
  }

  template <class Call>
  void guarded(const Call& call) {
    const py::gil_scoped_acquire lock;
    try {
      if (!failure_) call();
    } catch (py::error_already_set& error) {
      keep(std::move(error));
    }
  }

  void keep(py::error_already_set error) {  // guarded by the interpreter's lock
    if (!failure_) failure_.emplace(std::move(error));
    stop_ = true;
  }

  Progress progress_;
  std::atomic<bool> stop_{false};
  std::optional<py::error_already_set> failure_;
  std::mutex mutex_;
  std::string stage_;
  Clock::time_point told_{};
};

// Runs the body in another thread; every now and then calls `meanwhile` in this one, with the interpreter's lock.
void run_beside(const std::function<void()>& body, const std::function<void()>& meanwhile) {
  std::mutex mutex;
  std::condition_variable ended;
  bool done = false;
  std::exception_ptr failure;
  const py::gil_scoped_release release;
  std::thread worker([&] {
    try {
      body();
    } catch (...) {  // rethrown in the thread that called
      failure = std::current_exception();
    }
    const std::lock_guard lock(mutex);
    done = true;
    ended.notify_one();
  });
  std::unique_lock lock(mutex);
  while (!ended.wait_for(lock, kSignalInterval, [&] { return done; })) {
    lock.unlock();
    {
      const py::gil_scoped_acquire acquire;
      meanwhile();
    }
    lock.lock();
  }
  lock.unlock();
  worker.join();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace

void run_released(const RunArguments& arguments, const std::function<void(RunContext&)>& body) {
  RunContext context;
  context.seed = arguments.seed;
  context.threads = threads_of(arguments);
  if (arguments.timeout) {
    if (!(*arguments.timeout > 0)) {
      throw UsageError("timeout is " + std::to_string(*arguments.timeout) + "; it must be above 0 seconds");
    }
    const double seconds = std::min(*arguments.timeout, 1e9);  // the clock's own limit is near
    context.deadline =
        Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  }
  Progress progress = arguments.progress;
  if (py::isinstance<py::bool_>(progress)) {
    progress = py::module_::import("orbifit._progress").attr("bar")(progress);
  } else if (!progress.is_none() && PyCallable_Check(progress.ptr()) == 0) {
    throw py::type_error("progress is neither a function of stage and fraction, nor True, False or None");
  }
  Listener listener(progress, context);
  try {
    if (in_main_thread()) {
      run_beside([&] { body(context); }, [&] { listener.look_for_signals(); });
    } else {
      const py::gil_scoped_release release;
      body(context);
    }
  } catch (...) {  // also of what an exception of Python's stopped
    listener.raise();
    throw;
  }
  listener.raise();
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

}  // namespace orbifit::python

#include "stop_guard.h"

#include <csignal>
#include <system_error>

#include <unistd.h>

#include "files/file.h"
#include "interruption.h"

namespace orbifit {

StopGuard::StopGuard(const RunContext& run, std::function<int(StopReason)> last)
    : deadline_(run.deadline), last_(std::move(last)) {
  // Signals are for the thread that works: they end its waiting.
  sigset_t all;
  sigset_t before;
  sigfillset(&all);
  ::pthread_sigmask(SIG_SETMASK, &all, &before);
  try {
    thread_ = std::thread([this] { watch(); });
    Interruption::set_guarded(true);
  } catch (const std::system_error&) {  // no thread
  }
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

StopGuard::~StopGuard() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);  // never given where the program is being ended
    over_ = true;
  }
  Interruption::set_guarded(false);
  Interruption::wake();
  thread_.join();
}

std::optional<StopReason> StopGuard::reason() const {
  if (Interruption::count() > 0) return StopReason::interrupted;
  if (deadline_ && Clock::now() >= *deadline_) return StopReason::timeout;
  return std::nullopt;
}

bool StopGuard::over() {
  const std::lock_guard lock(mutex_);
  return over_;
}

void StopGuard::watch() {
  while (!over() && !reason()) Interruption::wait(deadline_);
  const Clock::time_point end = Clock::now() + kGrace;
  while (!over() && Interruption::count() < 2 && Clock::now() < end) Interruption::wait(end);
  const std::lock_guard lock(mutex_);
  if (over_) return;
  const int code = last_(*reason());
  abandon_unfinished_files();
  ::_exit(code);
}

}  // namespace orbifit

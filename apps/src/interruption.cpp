#include "interruption.h"

#include <csignal>
#include <ctime>

#include <semaphore.h>

namespace orbifit {

namespace {

// All that a signal handler may touch; it has no other way to it. NOLINTBEGIN(readability-identifier-naming)
std::atomic<bool> interrupted{false};
std::atomic<int> signals{0};
std::atomic<bool> watched{false};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free);
// NOLINTEND(readability-identifier-naming)

// Posting to it is one of the few things that a signal handler may do.
sem_t& bell() {
  static sem_t semaphore = [] {
    sem_t made;
    sem_init(&made, 0, 0);
    return made;
  }();
  return semaphore;
}

void on_signal(int number) {
  interrupted.store(true);
  if (signals++ > 0 && !watched) {
    std::signal(number, SIG_DFL);
    std::raise(number);
  }
  sem_post(&bell());
}

}  // namespace

const std::atomic<bool>& interruption() {
  bell();  // made before a signal can come
  struct sigaction action {};
  action.sa_handler = on_signal;
  action.sa_flags = static_cast<int>(SA_RESTART);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  return interrupted;
}

int Interruption::count() {
  return signals;
}

void Interruption::set_guarded(bool guarded) {
  watched = guarded;
}

void Interruption::wake() {
  sem_post(&bell());
}

void Interruption::wait(std::optional<std::chrono::steady_clock::time_point> longest) {
  if (!longest) {
    sem_wait(&bell());
    return;
  }
  const auto nanoseconds = std::chrono::duration_cast<std::chrono::nanoseconds>(longest->time_since_epoch()).count();
  const timespec time{nanoseconds / 1000000000, nanoseconds % 1000000000};
  sem_clockwait(&bell(), CLOCK_MONOTONIC, &time);
}

}  // namespace orbifit

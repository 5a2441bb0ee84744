#include "last_words.h"

#include <atomic>
#include <cstdlib>
#include <exception>
#include <new>
#include <string_view>
#include <utility>

#include <poll.h>
#include <unistd.h>

#include "files/file.h"

namespace orbifit {

namespace {

std::atomic<const LastWords*> words_of_process{nullptr};  // a handler has no parameters

// To a pipe that nobody empties nothing is written: the process is to end.
void write_if_ready(int descriptor, std::string_view text) {
  pollfd ready{descriptor, POLLOUT, 0};
  if (::poll(&ready, 1, 0) == 1) static_cast<void>(::write(descriptor, text.data(), text.size()) == 0);
}

[[noreturn]] void end_without_memory() {
  const LastWords* words = words_of_process;
  if (words == nullptr) write_if_ready(STDERR_FILENO, "orbifit: not enough memory\n");
  const int code = words == nullptr ? 1 : say(*words);
  abandon_unfinished_files();
  ::_exit(code);
}

// A std::bad_alloc that nobody can catch, as out of a destructor.
[[noreturn]] void end_on_lost_exception() {
  try {
    if (std::current_exception()) std::rethrow_exception(std::current_exception());
  } catch (const std::bad_alloc&) {
    if (const std::new_handler handler = std::get_new_handler()) handler();
  } catch (...) {
  }
  std::abort();
}

}  // namespace

int say(const LastWords& words) {
  if (::isatty(STDERR_FILENO) == 1) write_if_ready(STDERR_FILENO, "\r\033[K");
  write_if_ready(STDERR_FILENO, words.error);
  if (words.wants_object && words.wants_object()) write_if_ready(STDOUT_FILENO, words.object);
  return words.code;
}

EndWithoutMemory::EndWithoutMemory(LastWords words)
    : words_(std::move(words)),
      outer_(words_of_process.exchange(&words_)),
      outer_handler_(std::get_new_handler()),
      outer_terminate_(std::set_terminate(end_on_lost_exception)) {
  if (outer_handler_ == nullptr) std::set_new_handler(end_without_memory);
}

EndWithoutMemory::EndWithoutMemory()
    : outer_(words_of_process.exchange(nullptr)),
      outer_handler_(std::get_new_handler()),
      outer_terminate_(std::set_terminate(end_on_lost_exception)) {
  if (outer_handler_ == nullptr) std::set_new_handler(end_without_memory);
}

EndWithoutMemory::~EndWithoutMemory() {
  words_of_process = outer_;
  std::set_new_handler(outer_handler_);
  std::set_terminate(outer_terminate_);
}

}  // namespace orbifit

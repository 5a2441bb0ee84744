#pragma once

#include <exception>
#include <functional>
#include <new>
#include <string>

namespace orbifit {

/// What a process that must end at once says, and how it ends.
struct LastWords {
  std::string error;                   ///< a line for standard error
  std::string object;                  ///< for standard output
  std::function<bool()> wants_object;  ///< whether standard output is to have it; empty: no
  int code = 1;                        ///< exit code
};

/// Writes them while another thread works, which may be within the standard streams and hold their locks. Allocates
/// nothing. \return the exit code
int say(const LastWords& words);

/// While it lives, the process ends with these words where memory is missing: on the thread that asks, with unfinished
/// files removed, and without its stack unwound: an exception may be lost in a library on its way, and a matrix of
/// Eigen whose resizing throws releases its old memory twice. Allocates nothing from then on. Programs linked with
/// `--wrap=malloc` and `--wrap=realloc` (missing_memory.cpp) have what Eigen asks for watched too. A new handler that
/// the process has already, as an item of a batch does, stays and decides how it ends.
class EndWithoutMemory {
 public:
  explicit EndWithoutMemory(LastWords words);
  EndWithoutMemory();  ///< says on standard error that there is not enough memory, exit code 1; allocates nothing
                       ///< itself
  ~EndWithoutMemory();
  EndWithoutMemory(const EndWithoutMemory&) = delete;
  EndWithoutMemory& operator=(const EndWithoutMemory&) = delete;
  EndWithoutMemory(EndWithoutMemory&&) = delete;
  EndWithoutMemory& operator=(EndWithoutMemory&&) = delete;

 private:
  LastWords words_;
  const LastWords* outer_;
  std::new_handler outer_handler_;
  std::terminate_handler outer_terminate_;
};

}  // namespace orbifit

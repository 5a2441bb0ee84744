#pragma once

#include <cstdint>
#include <functional>

namespace orbifit {

/// While it lives, this process may take so many bytes of memory beside what it had mapped before.
class MemoryLimit {
 public:
  /// \param last what is to be done where more is asked for, on the thread that asks and without its stack unwound (an
  ///        exception may be lost in a library on its way); returns the exit code with which the process then ends,
  ///        unfinished files removed
  MemoryLimit(std::uint64_t bytes, std::function<int()> last);
  ~MemoryLimit();
  MemoryLimit(const MemoryLimit&) = delete;
  MemoryLimit& operator=(const MemoryLimit&) = delete;
  MemoryLimit(MemoryLimit&&) = delete;
  MemoryLimit& operator=(MemoryLimit&&) = delete;
};

}  // namespace orbifit

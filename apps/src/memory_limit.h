#pragma once

#include <cstdint>

#include "last_words.h"

namespace orbifit {

/// While it lives, this process may take so many bytes of memory beside what it had mapped before; it ends with these
/// words where more is asked for.
class MemoryLimit {
 public:
  MemoryLimit(std::uint64_t bytes, LastWords words);
  ~MemoryLimit();
  MemoryLimit(const MemoryLimit&) = delete;
  MemoryLimit& operator=(const MemoryLimit&) = delete;
  MemoryLimit(MemoryLimit&&) = delete;
  MemoryLimit& operator=(MemoryLimit&&) = delete;

 private:
  EndWithoutMemory end_;
};

}  // namespace orbifit

#pragma once

#include <cstddef>
#include <new>
#include <vector>

#include <sys/mman.h>

namespace orbifit::batch {

/// Memory that children do not get: what a fork costs grows with the pages that it has to copy the table of, 0.2 ms for
/// each MiB, and the lists of a million items are some 100 MiB that no child looks at.
template <typename T>
struct UnforkedAllocator {
  using value_type = T;

  UnforkedAllocator() = default;
  template <typename U>
  UnforkedAllocator(const UnforkedAllocator<U>&) {
  }  // NOLINT(google-explicit-constructor): as the standard's allocators

  T* allocate(std::size_t count) {
    void* memory = ::mmap(nullptr, count * sizeof(T), PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) throw std::bad_alloc();
    ::madvise(memory, count * sizeof(T), MADV_DONTFORK);
    return static_cast<T*>(memory);
  }
  void deallocate(T* memory, std::size_t count) { ::munmap(memory, count * sizeof(T)); }

  bool operator==(const UnforkedAllocator&) const { return true; }
};

/// A list that only the process which made it can read.
template <typename T>
using UnforkedVector = std::vector<T, UnforkedAllocator<T>>;

}  // namespace orbifit::batch

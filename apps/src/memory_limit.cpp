#include "memory_limit.h"

#include <algorithm>
#include <fstream>
#include <utility>

#include <sys/resource.h>
#include <unistd.h>

namespace orbifit {

namespace {

void set_address_space(rlim_t bytes) {
  rlimit limit{};
  ::getrlimit(RLIMIT_AS, &limit);
  limit.rlim_cur = std::min(bytes, limit.rlim_max);
  ::setrlimit(RLIMIT_AS, &limit);
}

}  // namespace

MemoryLimit::MemoryLimit(std::uint64_t bytes, LastWords words) : end_(std::move(words)) {
  std::ifstream stream("/proc/self/statm");
  rlim_t pages = 0;
  stream >> pages;
  const rlim_t mapped = pages * static_cast<rlim_t>(::sysconf(_SC_PAGESIZE));
  set_address_space(bytes > RLIM_INFINITY - 1 - mapped ? RLIM_INFINITY : mapped + bytes);
}

MemoryLimit::~MemoryLimit() {
  set_address_space(RLIM_INFINITY);
}

}  // namespace orbifit

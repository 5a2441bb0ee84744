#include "memory_limit.h"

#include <algorithm>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <new>
#include <utility>

#include <sys/resource.h>
#include <unistd.h>

#include "files/file.h"

namespace orbifit {

namespace {

std::function<int()> last_words;  // a handler has no parameters

void set_address_space(rlim_t bytes) {
  rlimit limit{};
  ::getrlimit(RLIMIT_AS, &limit);
  limit.rlim_cur = std::min(bytes, limit.rlim_max);
  ::setrlimit(RLIMIT_AS, &limit);
}

[[noreturn]] void end_without_memory() {
  set_address_space(RLIM_INFINITY);  // what follows may allocate
  const int code = last_words();
  abandon_unfinished_files();
  ::_exit(code);
}

// A std::bad_alloc that nobody can catch, as out of a destructor.
[[noreturn]] void end_on_lost_exception() {
  try {
    if (std::current_exception()) std::rethrow_exception(std::current_exception());
  } catch (const std::bad_alloc&) {
    end_without_memory();
  } catch (...) {
  }
  std::abort();
}

}  // namespace

MemoryLimit::MemoryLimit(std::uint64_t bytes, std::function<int()> last) {
  std::ifstream stream("/proc/self/statm");
  rlim_t pages = 0;
  stream >> pages;
  const rlim_t mapped = pages * static_cast<rlim_t>(::sysconf(_SC_PAGESIZE));
  last_words = std::move(last);
  std::set_new_handler(end_without_memory);
  std::set_terminate(end_on_lost_exception);
  set_address_space(bytes > RLIM_INFINITY - 1 - mapped ? RLIM_INFINITY : mapped + bytes);
}

MemoryLimit::~MemoryLimit() {
  set_address_space(RLIM_INFINITY);
  std::set_new_handler(nullptr);
  std::set_terminate(std::abort);
}

}  // namespace orbifit

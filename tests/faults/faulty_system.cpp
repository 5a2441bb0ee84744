// Preloaded into a program (LD_PRELOAD), makes one of its calls fail, as a system in need does:
//   ORBIFIT_FAIL_ALLOCATION=N   the N-th allocation of memory gives none, counted from 1; =N+ and all that follow
//   ORBIFIT_FAIL_WRITE=N        the N-th write to a file finds the disk full, and so do all that follow
//   ORBIFIT_END_READ=N          the N-th read of a file finds its end, as where it was cut meanwhile
//   ORBIFIT_COUNT_CALLS=FILE    when the program ends, FILE holds the numbers of allocations, writes and reads
// Standard streams never fail.
#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include <dlfcn.h>
#include <sys/stat.h>
#include <unistd.h>

// The C library's own, by the names under which it exports them for those who replace malloc.
extern "C" void* __libc_malloc(std::size_t size);
extern "C" void* __libc_calloc(std::size_t count, std::size_t size);
extern "C" void* __libc_realloc(void* memory, std::size_t size);
extern "C" void* __libc_memalign(std::size_t alignment, std::size_t size);

namespace {

struct Fault {
  std::atomic<long> calls{0};
  long first = 0;  // 0: none
  bool all_after = false;

  void set(const char* variable, bool all) {
    const char* text = std::getenv(variable);
    if (text == nullptr) return;
    first = std::atol(text);
    all_after = all || std::strchr(text, '+') != nullptr;
  }
  bool due() {
    const long call = ++calls;
    return first > 0 && (call == first || (all_after && call > first));
  }
};

Fault allocations, writes, reads;

int (*main_of_program)(int, char**, char**) = nullptr;

// Calls count from here on: what the libraries do before, no program can answer for.
int counted_main(int argc, char** argv, char** environment) {
  allocations.calls = writes.calls = reads.calls = 0;
  allocations.set("ORBIFIT_FAIL_ALLOCATION", false);
  writes.set("ORBIFIT_FAIL_WRITE", true);
  reads.set("ORBIFIT_END_READ", false);
  return main_of_program(argc, argv, environment);
}

__attribute__((destructor)) void end() {
  const char* name = std::getenv("ORBIFIT_COUNT_CALLS");
  if (name == nullptr) return;
  const long counts[3] = {allocations.calls, writes.calls, reads.calls};
  std::FILE* file = std::fopen(name, "w");
  if (file == nullptr) return;
  std::fprintf(file, "%ld %ld %ld\n", counts[0], counts[1], counts[2]);
  std::fclose(file);
}

bool no_memory() {
  if (!allocations.due()) return false;
  errno = ENOMEM;
  return true;
}

bool is_file(int descriptor) {
  struct stat status {};
  return descriptor > STDERR_FILENO && ::fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode);
}

}  // namespace

extern "C" {

int __libc_start_main(int (*main)(int, char**, char**), int argc, char** argv, void (*init)(), void (*fini)(),
                      void (*end_of_loader)(), void* stack_end) {
  main_of_program = main;
  const auto next = reinterpret_cast<decltype(&__libc_start_main)>(::dlsym(RTLD_NEXT, "__libc_start_main"));
  return next(counted_main, argc, argv, init, fini, end_of_loader, stack_end);
}

void* malloc(std::size_t size) {
  return no_memory() ? nullptr : __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  return no_memory() ? nullptr : __libc_calloc(count, size);
}
void* realloc(void* memory, std::size_t size) {
  return no_memory() ? nullptr : __libc_realloc(memory, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  return no_memory() ? nullptr : __libc_memalign(alignment, size);
}
int posix_memalign(void** memory, std::size_t alignment, std::size_t size) {
  *memory = no_memory() ? nullptr : __libc_memalign(alignment, size);
  return *memory == nullptr ? ENOMEM : 0;
}

ssize_t write(int descriptor, const void* bytes, std::size_t count) {
  static const auto next = reinterpret_cast<ssize_t (*)(int, const void*, std::size_t)>(::dlsym(RTLD_NEXT, "write"));
  if (is_file(descriptor) && writes.due()) {
    errno = ENOSPC;
    return -1;
  }
  return next(descriptor, bytes, count);
}

ssize_t read(int descriptor, void* bytes, std::size_t count) {
  static const auto next = reinterpret_cast<ssize_t (*)(int, void*, std::size_t)>(::dlsym(RTLD_NEXT, "read"));
  return is_file(descriptor) && reads.due() ? 0 : next(descriptor, bytes, count);
}

}  // extern "C"

// What the program's own code gets from malloc, as Eigen's matrices do, is watched as that of operator new is: the new
// handler is called where there is none. The linker makes calls of malloc those of __wrap_malloc.
#include <cstddef>
#include <new>

extern "C" {
void* __real_malloc(std::size_t size);
void* __real_realloc(void* memory, std::size_t size);
void* __wrap_malloc(std::size_t size);
void* __wrap_realloc(void* memory, std::size_t size);
}

namespace {

void* or_handled(void* memory, std::size_t size) {
  const std::new_handler handler = std::get_new_handler();
  if (memory == nullptr && size > 0 && handler != nullptr) handler();
  return memory;
}

}  // namespace

void* __wrap_malloc(std::size_t size) {
  return or_handled(__real_malloc(size), size);
}

void* __wrap_realloc(void* memory, std::size_t size) {
  return or_handled(__real_realloc(memory, size), size);
}

// A fuzzer (libFuzzer) of what bytes are made into: FUZZED_FUNCTION, of the header FUZZED_HEADER. Whatever it throws
// ends the fuzzer as a crash does.
#include <cstddef>
#include <cstdint>

#include FUZZED_HEADER

// lib3mf keeps 160 bytes of libzip's for each file that it reads.
extern "C" const char* __lsan_default_suppressions() {
  return "leak:lib3MF\nleak:libzip\n";
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  orbifit::FUZZED_FUNCTION({data, size});
  return 0;
}

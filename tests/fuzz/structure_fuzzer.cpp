// A fuzzer (libFuzzer) of what bytes are made into: FUZZED_FUNCTION, of the header FUZZED_HEADER. Whatever it throws
// ends the fuzzer as a crash does.
#include <cstddef>
#include <cstdint>

#include FUZZED_HEADER

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  orbifit::FUZZED_FUNCTION({data, size});
  return 0;
}

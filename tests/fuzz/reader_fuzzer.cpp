// One reader's fuzzer (libFuzzer): FUZZED_KIND is the kind of file, FUZZED_ENDING its ending. Whatever the bytes are,
// the reader returns something sound or refuses it with an InputError; any other exception ends the fuzzer as a crash
// does.
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

#include "bad_input/bad_input_lists.h"
#ifdef FUZZED_BY_MODEL
#include "model_reading.h"
#else
#include "reading.h"
#endif
#include "scratch_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace orbifit;
  constexpr BadInputKind kKind = BadInputKind::FUZZED_KIND;
  static const std::filesystem::path file = scratch_file(FUZZED_ENDING);
  std::string content(data, data + size);
#ifdef FUZZED_BY_MODEL
  static const Mesh cube = cube_of_bad_input();
  std::ofstream(file, std::ios::binary) << content;
  read_or_refused(file, [&] { return model_reading(kKind, file, cube); });
#else
  static const ReadingContext context;
  if (kKind == BadInputKind::basis) content = with_right_checksums(std::move(content));
  std::ofstream(file, std::ios::binary) << content;
  reading_of(kKind, file, context);
#endif
  return 0;
}

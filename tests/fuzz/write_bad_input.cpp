// write_bad_input FOLDER: writes every file of bad_input() and the damaged bases, and prints what its reader makes of
// each, a line each, as tests/robustness/outcomes.tsv holds them.
#include <cstdio>
#include <exception>

#include "files/file.h"
#include "reading.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("write_bad_input FOLDER\n", stderr);
    return 2;
  }
  try {
    using namespace orbifit;
    const std::filesystem::path folder(argv[1]);
    std::filesystem::create_directories(folder);
    const ReadingContext context;
    write_file(folder / "cube.obj", bad_input_cube());
    write_file(folder / "cube.basis", context.basis);
    std::vector<BadInput> files = bad_input();
    for (BadInput& basis : damaged_bases(context.basis)) files.push_back(std::move(basis));
    for (const BadInput& file : files) {
      write_file(folder / file.name, file.content);
      std::string outcome;
      try {
        outcome = reading_of(file.kind, folder / file.name, context);
      } catch (const std::exception& error) {
        outcome = std::string("DEFECT: ") + error.what();
      }
      std::printf("%s\t%s\n", file.name.c_str(), outcome.c_str());
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}

#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "files/file.h"

namespace orbifit {
namespace {

// tests/package builds the file and runs it.
TEST(Readme, LibraryPageShowsTheExampleAsItIs) {
  const std::filesystem::path source = ORBIFIT_SOURCE;
  const std::string example = read_file(source / "apps/examples/edit.cpp");
  EXPECT_NE(read_file(source / "docs/library.md").find("```cpp\n" + example + "```\n"), std::string::npos);
}

}  // namespace
}  // namespace orbifit

#include <filesystem>

#include <gtest/gtest.h>

#include "orbifit/model/annotation_io.h"
#include "orbifit/model/mesh_io.h"

#include "cube.h"
#include "program.h"

namespace orbifit {
namespace {

class TooLittleMemory : public testing::TestWithParam<const char*> {};

TEST_P(TooLittleMemory, EndsTheCommandWithAReasonAndNoFile) {
  const Program program;
  const Mesh cube = cube_mesh(40);
  write_mesh(program.folder().file("cube.ply"), cube);
  write_annotation(program.folder().file("cube.json"), cube_annotation(cube));
  program.folder().write("handles.json", R"({"handles": [{"vertices": [0], "translation": [0.1, 0, 0]}]})");
  const auto before = program.folder().listing();
  for (const char* memory : {"64K", "1M", "20M"}) {
    const ProgramResult result = program.run(std::string(GetParam()) + " --max-memory " + memory);
    if (result.code == 0 && std::string(memory) == "20M") continue;  // which suffices for some
    EXPECT_EQ(result.code, 4) << memory << result.errors;
    EXPECT_NE(result.errors.find("orbifit: not enough memory: more is needed than --max-memory allows\n"),
              std::string::npos)
        << memory << result.errors;
    EXPECT_EQ(program.folder().listing(), before) << memory;
  }
}

INSTANTIATE_TEST_SUITE_P(Commands, TooLittleMemory,
                         testing::Values("info cube.ply", "detect cube.ply -o out.json", "convert cube.ply out.obj",
                                         "subspace cube.ply cube.json -o out.basis", "check cube.ply cube.json",
                                         "symmetrize cube.ply cube.json -o out.ply", "render cube.ply -o out.png",
                                         "deform cube.ply cube.json --handles handles.json -o out.ply",
                                         "scan cube.ply -o out.ply", "fit cube.ply cube.ply -o out.ply"));

TEST(MemoryLimit, ThatSufficesChangesNothing) {
  const Program program;
  write_mesh(program.folder().file("cube.ply"), cube_mesh());
  const ProgramResult free = program.run("info cube.ply --json");
  const ProgramResult limited = program.run("info cube.ply --json --max-memory 2G");
  EXPECT_EQ(limited.code, 0) << limited.errors;
  EXPECT_EQ(limited.output, free.output);
}

}  // namespace
}  // namespace orbifit

#include "orbifit/detection/detect.h"

#include <string>

#include <gtest/gtest.h>

#include "orbifit/model/annotation_io.h"
#include "orbifit/model/mesh_io.h"

#include "files/file.h"
#include "program.h"

namespace orbifit {
namespace {

// The program adds nothing to what the library's detect() returns, and leaves nothing of it out.
TEST(Detect, ProgramAndLibraryGiveTheSameAnnotation) {
  for (const std::string name : {"bar", "desk_fan"}) {
    const Program program;
    ASSERT_EQ(program.run("generate " + name + " -o . --quiet").code, 0);
    ASSERT_EQ(program.run("detect " + name + ".ply -o program.json --seed 3 --quiet").code, 0);
    const TemporaryFolder& folder = program.folder();
    RunContext context;
    context.seed = 3;
    write_annotation(folder.file("library.json"), detect(read_mesh(folder.file(name + ".ply")), {}, context));
    EXPECT_EQ(read_file(folder.file("program.json")), read_file(folder.file("library.json"))) << name;
  }
}

}  // namespace
}  // namespace orbifit

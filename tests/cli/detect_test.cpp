#include "orbifit/detection/detect.h"

#include <algorithm>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

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

// Copies share a line of the table; the files and --json have each of them, and what each saves.
TEST(Detect, ListsByImportance) {
  const Program program;
  ASSERT_EQ(program.run("generate chair -o . --quiet").code, 0);
  const auto found = [&](const std::string& options) {
    return nlohmann::json::parse(program.run("detect chair.ply --json --quiet" + options).output);
  };
  const nlohmann::json list = found("");
  const nlohmann::json all = found(" --all");
  ASSERT_GT(list["regions"].size(), 4U);
  EXPECT_LT(list["regions"].size(), all["regions"].size());
  for (const nlohmann::json& region : list["regions"]) {
    EXPECT_TRUE(region["importance"].is_number()) << region["name"];
    EXPECT_TRUE(std::ranges::any_of(all["regions"], [&](const nlohmann::json& other) {
      return other["group"] == region["group"] && other["faces"] == region["faces"];
    })) << region["name"];
  }
  const std::string table = program.run("detect chair.ply").output;
  const auto lines = static_cast<std::size_t>(std::ranges::count(table, '\n'));
  EXPECT_GT(lines, 4U);
  EXPECT_LT(lines, list["regions"].size());
  EXPECT_NE(table.find("4 bars"), std::string::npos) << table;
}

}  // namespace
}  // namespace orbifit

#include "orbifit/detection/detect.h"

#include <algorithm>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "orbifit/model/annotation_io.h"
#include "orbifit/model/appearance.h"
#include "orbifit/model/mesh_io.h"

#include "cube.h"
#include "files/file.h"
#include "painted.h"
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

// What colours break is told in the text, in JSON and in the annotation, which others read all the same.
TEST(Detect, TellsWhatColoursBreak) {
  const Program program;
  const TemporaryFolder& folder = program.folder();
  const Mesh cube = cube_mesh(8);
  const auto half = [](const Eigen::Vector3d& p) {
    return p.x() > 0 ? Eigen::Vector3d(0.8, 0.1, 0.1) : Eigen::Vector3d(1, 1, 1);
  };
  write_mesh(folder.file("cube.ply"), cube, test::painted(cube, test::Paint::vertices, half));
  const ProgramResult told = program.run("detect cube.ply --colours -o cube.json");
  ASSERT_EQ(told.code, 0) << told.errors;
  EXPECT_NE(told.output.find("Broken by colours: Oh of"), std::string::npos) << told.output;
  EXPECT_NE(told.output.find("of which C4v is left"), std::string::npos) << told.output;
  const nlohmann::json listed = nlohmann::json::parse(program.run("detect cube.ply --colours --json --quiet").output);
  EXPECT_EQ(listed["broken_by_colours"][0]["group"], "Oh");
  EXPECT_EQ(listed["broken_by_colours"][0]["kept_as"], "C4v");
  const nlohmann::json file = nlohmann::json::parse(read_file(folder.file("cube.json")));
  EXPECT_EQ(file["broken_by_colours"], listed["broken_by_colours"]);
  const SymmetryAnnotation found = read_annotation(folder.file("cube.json"), cube);
  ASSERT_FALSE(found.regions.empty());
  EXPECT_EQ(found.regions.front().group.symbol(), "C4v");
  EXPECT_EQ(program.run("detect cube.ply --json --quiet").output.find("broken_by_colours"), std::string::npos);
}

TEST(Detect, SaysThatThereAreNoColours) {
  const Program program;
  write_mesh(program.folder().file("cube.ply"), cube_mesh());
  const ProgramResult plain = program.run("detect cube.ply --colours -o cube.json");
  EXPECT_EQ(plain.code, 0);
  EXPECT_NE(plain.errors.find("no colours"), std::string::npos) << plain.errors;
  EXPECT_EQ(program.run("detect cube.ply --colours --points").code, 2);
}

}  // namespace
}  // namespace orbifit

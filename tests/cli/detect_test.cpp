#include "orbifit/detection/detect.h"

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

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

// Boxes, each an object of its own: eight corners, twelve triangles.
std::string named_boxes(const std::vector<std::pair<std::string, std::array<double, 6>>>& boxes) {
  static constexpr int kSides[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                        {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  std::string text;
  int first = 1;
  for (const auto& [name, bounds] : boxes) {
    text += "o " + name + "\n";
    for (int corner = 0; corner < 8; ++corner) {
      text += "v";
      for (std::size_t k = 0; k < 3; ++k) text += " " + std::to_string(bounds[2 * k + (corner >> k & 1)]);
      text += "\n";
    }
    for (const auto& side : kSides) {
      text += "f";
      for (const int corner : side) text += " " + std::to_string(first + corner);
      text += "\n";
    }
    first += 8;
  }
  return text;
}

TEST(Detect, CallsRegionsAsTheFileCallsItsParts) {
  const Program program;
  write_file(program.folder().file("stool.obj"), named_boxes({{"seat", {-1, 1, -1, 1, 1, 1.2}},
                                                              {"foot.001", {-1, -0.8, -1, -0.8, 0, 1}},
                                                              {"foot.002", {0.8, 1, -1, -0.8, 0, 1}},
                                                              {"foot.003", {-1, -0.8, 0.8, 1, 0, 1}},
                                                              {"foot.004", {0.8, 1, 0.8, 1, 0, 1}}}));
  const ProgramResult outcome = program.run("detect stool.obj --all --json --quiet");
  ASSERT_EQ(outcome.code, 0) << outcome.errors;
  std::string names;
  const nlohmann::json listed = nlohmann::json::parse(outcome.output);
  for (const nlohmann::json& region : listed["regions"]) {
    names += region.value("name", "?") + "; ";
  }
  EXPECT_NE(names.find("whole; "), std::string::npos) << names;
  EXPECT_NE(names.find("upper seat; "), std::string::npos) << names;
  EXPECT_NE(names.find("foot 1 of 4, "), std::string::npos) << names;
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

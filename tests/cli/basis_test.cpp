#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "orbifit/model/annotation_io.h"
#include "orbifit/model/mesh_io.h"

#include "cube.h"
#include "files/file.h"
#include "program.h"

namespace orbifit {
namespace {

using nlohmann::json;

class StoredBasis : public testing::Test {
 protected:
  void SetUp() override {
    const Mesh cube = cube_mesh();
    write_mesh(file("cube.ply"), cube);
    write_mesh(file("other.ply"), cube_mesh(5));
    SymmetryAnnotation annotation = cube_annotation(cube);
    // What the cube has about an axis, and a side across it with a group of its own, which the rest has not: it stays
    // flat.
    std::vector<int> side;
    for (int face = 0; face < cube.faces.rows() / 6; ++face) side.push_back(face);
    GroupFrame frame;
    frame << 0, 0, -1, 0, 1, 0, 1, 0, 0;
    annotation.regions.front() = make_region(*PointGroup::parse("C4v"), Eigen::Vector3d::Zero(), frame,
                                             annotation.regions.front().faces, "cube");
    annotation.regions.push_back(
        make_region(*PointGroup::parse("D4h"), Eigen::Vector3d(-0.5, 0, 0), frame, std::move(side), "side"));
    annotation.regions.back().id = 1;
    annotation.regions.back().parent = 0;
    write_annotation(file("cube.json"), annotation);
    annotation.regions.pop_back();
    write_annotation(file("whole.json"), annotation);
    write_annotation(file("other.json"), cube_annotation(cube_mesh(5)));
    program_.folder().write("handles.json", R"({"handles": [
      {"name": "corner", "centre": [0.5, 0.5, 0.5], "radius": 0.1, "translation": [0.1, 0.2, 0.05]},
      {"name": "held", "centre": [-0.5, 0, 0], "radius": 0.2}]})");
    const ProgramResult stored = program_.run("subspace cube.ply cube.json --radius 0.3 --mode floating -o cube.basis");
    ASSERT_EQ(stored.code, 0) << stored.errors;
    ASSERT_NE(stored.output.find("cube.basis"), std::string::npos) << stored.output;
  }

  std::filesystem::path file(const std::string& name) const { return program_.folder().file(name); }

  // Fails with this exit code and these words, and writes nothing.
  void expect_refusal(const std::string& arguments, int code, const std::string& words) const {
    const auto before = program_.folder().listing();
    const ProgramResult result = program_.run(arguments);
    EXPECT_EQ(result.code, code) << arguments;
    EXPECT_NE(result.errors.find(words), std::string::npos) << arguments << "\n" << result.errors;
    EXPECT_EQ(program_.folder().listing(), before);
  }

  Program program_;
};

TEST_F(StoredBasis, DeformsAsTheBuiltOneDoes) {
  const ProgramResult built = program_.run(
      "deform cube.ply cube.json --handles handles.json --radius 0.3 -o built.ply --annotation-out built.json --json");
  ASSERT_EQ(built.code, 0) << built.errors;
  const ProgramResult loaded = program_.run(
      "deform cube.ply cube.json --handles handles.json --basis cube.basis -o loaded.ply --annotation-out loaded.json "
      "--json");
  ASSERT_EQ(loaded.code, 0) << loaded.errors;
  EXPECT_TRUE(read_file(file("loaded.ply")) == read_file(file("built.ply")));
  EXPECT_TRUE(read_file(file("loaded.json")) == read_file(file("built.json")));
  EXPECT_NE(read_mesh(file("loaded.ply")).vertices, cube_mesh().vertices);
  json here = json::parse(loaded.output), there = json::parse(built.output);
  EXPECT_EQ(there["basis"], "built");
  EXPECT_EQ(here["basis"], "loaded");
  EXPECT_GT(here["milliseconds"]["subspace"], 0);
  for (const char* different : {"basis", "milliseconds"}) {
    here.erase(different);
    there.erase(different);
  }
  EXPECT_EQ(here, there);
}

TEST_F(StoredBasis, IsTheSameFileWithAnyNumberOfThreads) {
  ASSERT_EQ(program_.run("subspace cube.ply cube.json --radius 0.3 -o two.basis --threads 2").code, 0);
  ASSERT_EQ(program_.run("subspace cube.ply cube.json --radius 0.3 -o one.basis --threads 1").code, 0);
  EXPECT_TRUE(read_file(file("one.basis")) == read_file(file("two.basis")));
}

TEST_F(StoredBasis, KeepsItsModeAndLift) {
  ASSERT_EQ(program_.run("subspace cube.ply cube.json --radius 0.3 --mode moving --lift paper -o paper.basis").code, 0);
  const ProgramResult result =
      program_.run("deform cube.ply cube.json --handles handles.json --basis paper.basis -o moved.ply --json");
  ASSERT_EQ(result.code, 0) << result.errors;
  EXPECT_EQ(json::parse(result.output)["mode"], "moving");
  EXPECT_EQ(json::parse(result.output)["lift"], "paper");
}

TEST_F(StoredBasis, IsRefusedWhereItDoesNotBelong) {
  const std::string call = " --handles handles.json -o out.ply --basis ";
  expect_refusal("deform other.ply other.json" + call + "cube.basis", 3,
                 "cube.basis: source, mesh: the basis is of a mesh");
  expect_refusal("deform cube.ply whole.json" + call + "cube.basis", 3, "cube.basis: source, annotation: ");
  expect_refusal("deform cube.ply cube.json" + call + "none.basis", 3, "none.basis: no such file");
  expect_refusal("deform cube.ply cube.json" + call + "cube.ply", 3, "cube.ply: is not a basis");
}

TEST_F(StoredBasis, IsRefusedWhenDamaged) {
  const std::string call = "deform cube.ply cube.json --handles handles.json -o out.ply --basis ";
  const std::string content = read_file(file("cube.basis"));
  program_.folder().write("cut.basis", content.substr(0, content.size() / 2));
  expect_refusal(call + "cut.basis", 3, "cut.basis: header: the file is cut off");
  std::string flipped = content;
  flipped[content.size() - 100] = static_cast<char>(flipped[content.size() - 100] ^ 4);
  program_.folder().write("flipped.basis", flipped);
  expect_refusal(call + "flipped.basis", 3, "flipped.basis: basis: is damaged");
  std::string newer = content;
  newer[8] = 9;
  program_.folder().write("newer.basis", newer);
  expect_refusal(call + "newer.basis", 3, "newer.basis: version: is 9");
}

TEST_F(StoredBasis, ExcludesWhatItHasDecided) {
  const std::string call = "deform cube.ply cube.json --handles handles.json -o out.ply --basis cube.basis ";
  for (const char* option : {"--mode fixed", "--radius 0.2", "--samples 100", "--lift paper", "--sharp-features"}) {
    expect_refusal(call + option, 2, "--basis excludes");
  }
}

TEST_F(StoredBasis, OverwritesNoInput) {
  expect_refusal("subspace cube.ply cube.json -o cube.ply", 2, "would overwrite the input");
  expect_refusal("subspace cube.ply cube.json -o cube.json", 2, "would overwrite the input");
  expect_refusal("subspace cube.ply cube.json -o none/cube.basis", 3, "does not exist");
  expect_refusal("deform cube.ply cube.json --handles handles.json --basis cube.basis -o cube.basis", 2,
                 "would overwrite the input");
}

TEST_F(StoredBasis, LiftsAreComparedRegionByRegion) {
  const ProgramResult result = program_.run("subspace cube.ply cube.json --radius 0.3 --compare-lifts --json");
  ASSERT_EQ(result.code, 0) << result.errors;
  const json report = json::parse(result.output);
  EXPECT_EQ(report["lift"], "orbit");
  const json& side = report["regions"][1];
  EXPECT_LT(side["residual_of_lift"]["orbit"]["max"], 1e-12);
  EXPECT_GT(side["residual_of_lift"]["paper"]["max"], 1e-6);
  EXPECT_EQ(side["field_residual"], side["residual_of_lift"]["orbit"]);
  const ProgramResult table = program_.run("subspace cube.ply cube.json --radius 0.3 --lift paper --compare-lifts");
  EXPECT_LT(table.output.find("paper lift"), table.output.find("orbit lift")) << table.output;
  EXPECT_NE(table.output.find("orbit lift"), std::string::npos) << table.output;
  EXPECT_EQ(program_.run("subspace cube.ply cube.json --radius 0.3").output.find("paper lift"), std::string::npos);
}

TEST_F(StoredBasis, SamplingFollowsARadiusFieldAndSharpFeatures) {
  const auto samples = [&](const std::string& options) {
    const ProgramResult result = program_.run("subspace cube.ply whole.json --radius 0.3 --json " + options);
    EXPECT_EQ(result.code, 0) << result.errors;
    return json::parse(result.output)["samples"].get<int>();
  };
  program_.folder().write("field.json", R"({"areas": [{"centre": [0.5, 0.5, 0.5], "radius": 0.2, "factor": 0.4}]})");
  program_.folder().write("even.json", R"({"areas": []})");
  const int even = samples("");
  EXPECT_EQ(samples("--radius-field even.json"), even);
  EXPECT_GT(samples("--radius-field field.json"), even);
  EXPECT_NE(samples("--sharp-features"), even);
  program_.folder().write("wrong.json", R"({"areas": [{"centre": [0, 0], "radius": 1, "factor": 1}]})");
  expect_refusal("subspace cube.ply cube.json --radius-field wrong.json -o out.basis", 3,
                 "wrong.json: areas[0].centre");
}

}  // namespace
}  // namespace orbifit

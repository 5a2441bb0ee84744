#include "program.h"

#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "orbifit/model/annotation_io.h"
#include "orbifit/model/mesh_io.h"
#include "orbifit/model/scan_io.h"

#include "cube.h"
#include "files/file.h"

namespace orbifit {
namespace {

using nlohmann::json;

class OrbifitProgram : public testing::Test {
 protected:
  void SetUp() override {
    write_mesh(file("cube.ply"), cube_);
    write_annotation(file("cube.json"), cube_annotation(cube_));
  }

  std::filesystem::path file(const std::string& name) const { return program_.folder().file(name); }
  std::string bytes(const std::string& name) const { return read_file(file(name)); }

  // Runs what must succeed in silence on stderr.
  std::string run(const std::string& line) const {
    const ProgramResult result = program_.run(line);
    EXPECT_EQ(result.code, 0) << line << "\n" << result.errors;
    EXPECT_EQ(result.errors, "") << line;
    return result.output;
  }

  Program program_;
  Mesh cube_ = cube_mesh();
};

TEST_F(OrbifitProgram, SaysItsVersion) {
  EXPECT_TRUE(run("--version").starts_with("orbifit "));
}

TEST_F(OrbifitProgram, HelpOfEveryCommandOpensWithExamples) {
  const std::string help = run("--help");
  std::size_t at = help.find("Subcommands:\n");
  ASSERT_NE(at, std::string::npos);
  std::istringstream lines(help.substr(at + 13));
  int commands = 0;
  for (std::string line; std::getline(lines, line) && line.starts_with("  "); ++commands) {
    const std::string name = line.substr(2, line.find(' ', 2) - 2);
    const std::string text = run(name + " --help");
    EXPECT_TRUE(text.starts_with("Examples:\n  orbifit " + name)) << text;
    for (const char* option : {"--json", "--seed", "--threads", "--timeout", "--quiet"}) {
      EXPECT_NE(text.find(option), std::string::npos) << name << " " << option;
    }
  }
  EXPECT_GE(commands, 7);
}

TEST_F(OrbifitProgram, InfoCounts) {
  const json info = json::parse(run("info cube.ply --json"));
  EXPECT_EQ(info["vertices"], cube_.vertices.rows());
  EXPECT_EQ(info["faces"], 384);
  EXPECT_EQ(info["components"], 1);
  EXPECT_EQ(info["watertight"], true);
  EXPECT_NEAR(info["area"], 6, 1e-12);
  EXPECT_NEAR(info["volume"], 1, 1e-12);
  const std::string text = run("info cube.ply");
  EXPECT_NE(text.find("384 triangles"), std::string::npos) << text;
}

TEST_F(OrbifitProgram, DetectsWhatCheckConfirms) {
  const json found = json::parse(run("detect cube.ply -o found.json --colour found.ply --json --quiet"));
  ASSERT_FALSE(found["regions"].empty());
  EXPECT_EQ(found["regions"][0]["group"], "Oh");
  EXPECT_EQ(read_annotation(file("found.json"), cube_).regions.front().group.symbol(), "Oh");
  EXPECT_EQ(read_mesh(file("found.ply")).faces, cube_.faces);
  const json check = json::parse(run("check cube.ply found.json --max-residual 1e-9 --json --quiet"));
  EXPECT_EQ(check["vertices_onto_vertices"], true);
  EXPECT_LT(check["residual"], 1e-9);
}

TEST_F(OrbifitProgram, CheckExitsWith1AboveItsLimit) {
  Mesh bent = cube_;
  bent.vertices.col(0) += 0.1 * bent.vertices.col(2).cwiseProduct(bent.vertices.col(2));
  write_mesh(file("bent.ply"), bent);
  const ProgramResult rest = program_.run("check bent.ply cube.json --max-residual 1e-3 --json");
  EXPECT_EQ(rest.code, 1);
  EXPECT_GT(json::parse(rest.output)["residual"], 1e-3);
  EXPECT_NE(rest.errors.find("is above the limit 0.001"), std::string::npos) << rest.errors;

  const ProgramResult deformed =
      program_.run("check cube.ply cube.json --deformed bent.ply --max-residual 1e-3 --json");
  EXPECT_EQ(deformed.code, 1);
  const json report = json::parse(deformed.output);
  EXPECT_LT(report["regions"][0]["floor"]["max"], 1e-12);
  EXPECT_GT(report["regions"][0]["excess"]["max"], 1e-3);
  EXPECT_GE(report["regions"][0]["worst_vertex"], 0);
  EXPECT_EQ(program_.run("check cube.ply cube.json --deformed cube.ply --max-residual 1e-12").code, 0);
}

TEST_F(OrbifitProgram, GeneratesEveryModelItLists) {
  const json list = json::parse(run("generate --list --json"));
  ASSERT_GE(list["models"].size(), 5U);
  for (const json& model : list["models"]) {
    const std::string name = model["name"];
    EXPECT_NE(run("generate --list").find(name + ": "), std::string::npos);
    const json made = json::parse(run("generate " + name + " -o models --json"));
    const Mesh mesh = read_mesh(file(made["mesh"]));
    EXPECT_EQ(mesh.vertices.rows(), made["vertices"]);
    EXPECT_EQ(read_annotation(file(made["annotation"]), mesh).regions.size(), made["regions"]);
  }
}

TEST_F(OrbifitProgram, ScansIntoEveryFormat) {
  for (const std::string ending : {"ply", "pcd", "xyz", "pts"}) {
    const std::string name = "scan." + ending;
    const json scan = json::parse(run("scan cube.ply --views 2 --width 40 --height 30 --json -o " + name));
    EXPECT_EQ(read_scan(file(name)).points.rows(), scan["points"]);
  }
}

TEST_F(OrbifitProgram, ConvertsMeshesAndScans) {
  run("convert cube.ply cube.obj");
  run("convert cube.obj cube.off");
  run("convert cube.off again.ply");
  EXPECT_TRUE(bytes("again.ply") == bytes("cube.ply"));
  run("convert again.ply again.ply");  // onto itself
  EXPECT_TRUE(bytes("again.ply") == bytes("cube.ply"));
  run("convert cube.ply cube.xyz");
  EXPECT_EQ(read_scan(file("cube.xyz")).points, cube_.vertices);
  run("convert cube.ply points.ply --points");
  EXPECT_EQ(read_scan(file("points.ply")).points, cube_.vertices);
  EXPECT_EQ(program_.run("info points.ply").code, 3);
}

TEST_F(OrbifitProgram, DrawsPictures) {
  const json picture =
      json::parse(run("render cube.ply --annotation cube.json --width 64 --height 48 --json -o a.png"));
  EXPECT_EQ(picture["width"], 64);
  EXPECT_TRUE(bytes("a.png").starts_with("\x89PNG"));
}

// Every file and the output of a command, with one thread and with two, must agree to the byte.
class SameBytes : public OrbifitProgram, public testing::WithParamInterface<std::string> {};

TEST_P(SameBytes, WithAnyNumberOfThreads) {
  std::vector<std::string> outputs;
  std::vector<std::map<std::string, std::string>> files;
  for (const std::string threads : {"1", "2", "2"}) {
    outputs.push_back(run(GetParam() + " --quiet --seed 7 --threads " + threads));
    auto& content = files.emplace_back();
    for (const std::string& name : program_.folder().listing()) {
      if (std::filesystem::is_regular_file(file(name))) content[name] = bytes(name);
    }
  }
  EXPECT_EQ(outputs[0], outputs[1]);
  EXPECT_EQ(outputs[1], outputs[2]);
  EXPECT_TRUE(files[0] == files[1]);
  EXPECT_TRUE(files[1] == files[2]);
  EXPECT_EQ(files[0].count("cube.ply"), 1U);
}

TEST_P(SameBytes, SilentAboutMoreThreadsThanCores) {
  const ProgramResult result = program_.run(GetParam() + " --quiet --threads 64");
  EXPECT_EQ(result.code, 0);
  EXPECT_EQ(result.errors, "");
}

INSTANTIATE_TEST_SUITE_P(Commands, SameBytes,
                         testing::Values("detect cube.ply -o a.json --colour a.ply",
                                         "scan cube.ply --noise 0.01 --outliers 0.1 -o a.ply",
                                         "render cube.ply --width 80 --height 60 -o a.png", "generate table -o a",
                                         "check cube.ply cube.json"));

TEST_F(OrbifitProgram, SeedsDiffer) {
  run("scan cube.ply --noise 0.01 --seed 1 -o a.ply");
  run("scan cube.ply --noise 0.01 --seed 2 -o b.ply");
  EXPECT_FALSE(bytes("a.ply") == bytes("b.ply"));
}

}  // namespace
}  // namespace orbifit

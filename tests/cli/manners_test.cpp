#include <fstream>
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
#include "program.h"

namespace orbifit {
namespace {

using nlohmann::json;

/// Runs lines of the shell, with `$orbifit` for the program.
class Manners : public testing::Test {
 protected:
  void SetUp() override {
    write_mesh(file("cube.ply"), cube_);
    SymmetryAnnotation annotation = cube_annotation(cube_);
    annotation.regions.front().name = "all of it";
    write_annotation(file("cube.json"), annotation);
    shell_.folder().write(
        "handles.json",
        R"({"handles": [{"name": "top", "centre": [0, 0, 0.5], "radius": 0.2, "translation": [0, 0, 0.1]}]})");
  }

  std::filesystem::path file(const std::string& name) const { return shell_.folder().file(name); }

  ProgramResult run(const std::string& line) const {
    return shell_.run(std::vector<std::string>{"-c", "orbifit=" ORBIFIT_PROGRAM "; " + line});
  }

  Program shell_{"/bin/sh"};
  Mesh cube_ = cube_mesh();
};

TEST_F(Manners, ErrorsAreJsonWhereJsonIsAskedFor) {
  const std::vector<std::pair<std::string, int>> calls{
      {"info none.obj", 3},          {"polish cube.ply", 2},
      {"info cube.ply --sharp", 2},  {"check cube.ply cube.json --mode loose", 2},
      {"generate teapot -o out", 2}, {"detect cube.ply --timeout 1e-6", 4}};
  for (const auto& [call, code] : calls) {
    const ProgramResult result = run("$orbifit " + call + " --json");
    EXPECT_EQ(result.code, code) << call;
    const json object = json::parse(result.output);  // one object and nothing else
    EXPECT_EQ(object["exit_code"], code) << call;
    EXPECT_EQ("orbifit: " + object["error"].get<std::string>() + "\n", result.errors) << call;
  }
}

TEST_F(Manners, QuietIsQuiet) {
  for (const std::string call :
       {"info cube.ply", "generate bar -o models", "generate --list", "detect cube.ply -o a.json",
        "check cube.ply cube.json", "check cube.ply cube.json --max-residual 1",
        "render cube.ply --width 40 --height 30 -o a.png", "convert cube.ply a.obj",
        "scan cube.ply --width 40 --height 30 -o a.xyz", "annotate cube.ply --annotation cube.json --list",
        "deform cube.ply cube.json --handles handles.json -o b.ply"}) {
    const ProgramResult result = run("$orbifit " + call + " --quiet");
    EXPECT_EQ(result.code, 0) << call << result.errors;
    EXPECT_EQ(result.output + result.errors, "") << call;
  }
  EXPECT_NE(run("$orbifit info none.ply --quiet").errors, "");
  EXPECT_NO_THROW(json::parse(run("$orbifit info cube.ply --quiet --json").output));
}

TEST_F(Manners, AWrongNameListsTheRightOnes) {
  const std::vector<std::pair<std::string, std::string>> calls{
      {"polish cube.ply", "there are info, detect, "},
      {"info cube.ply --jsn", "did you mean --json?"},
      {"detect cube.ply --tolerence 0.1", "did you mean --tolerance?"},
      {"info cube.ply --magic-wand", "there are --"},
      {"generate teapot -o out", "armchair, bar, "},
      {"generate bar --param wheels=2 -o out", "there are length, "},
      {"deform cube.ply cube.json --handles handles.json --mode loose -o b.ply",
       "--mode is 'loose': must be one of fixed, floating, moving"},
      {"render cube.ply --annotation cube.json --region 7 -o a.png", "there are 0 (all of it)"},
      {"annotate cube.ply --annotation cube.json -o a.json --remove 7", "there are 0 (all of it)"},
      {"symmetrize cube.ply cube.json --without 7 -o a.ply", "there are 0 (all of it)"}};
  for (const auto& [call, words] : calls) {
    const ProgramResult result = run("$orbifit " + call);
    EXPECT_EQ(result.code, 2) << call;
    EXPECT_NE(result.errors.find(words), std::string::npos) << result.errors;
  }
}

TEST_F(Manners, AHyphenIsStandardInputAndOutput) {
  const auto expect_done = [&](const std::string& line) {
    const ProgramResult result = run(line);
    EXPECT_EQ(result.code, 0) << line << "\n" << result.errors;
    return result;
  };
  // Every format that can be written is known again by its content.
  for (const std::string format : {"obj", "off", "ply", "stl", "glb"}) {
    expect_done("$orbifit convert cube.ply - --output-format " + format + " 2>/dev/null | $orbifit convert - " +
                format + "_back.ply");
    expect_done("$orbifit convert cube.ply direct." + format + " && $orbifit convert direct." + format + " direct.ply");
    EXPECT_TRUE(read_file(file(format + "_back.ply")) == read_file(file("direct.ply"))) << format;
  }
  for (const std::string format : {"ply", "pcd", "xyz", "pts"}) {
    expect_done("$orbifit convert cube.ply --points - --output-format " + format +
                " 2>/dev/null | $orbifit convert - --points back.xyz");
    EXPECT_EQ(read_scan(file("back.xyz")).points.rows(), cube_.vertices.rows()) << format;
  }
  // Annotations have one format.
  expect_done("$orbifit detect - -o - <cube.ply 2>/dev/null >found.json && $orbifit check cube.ply - <found.json");
  EXPECT_EQ(read_annotation(file("found.json"), cube_).regions.front().group.symbol(), "Oh");
  // Handles, and a mesh on standard output alone: what is said of it goes to stderr.
  const ProgramResult edited =
      expect_done("$orbifit deform cube.ply cube.json --handles - -o - --output-format off <handles.json");
  EXPECT_TRUE(edited.output.starts_with("OFF"));
  EXPECT_NE(edited.errors.find("1 handle"), std::string::npos) << edited.errors;
}

TEST_F(Manners, AHyphenThatCannotBeServedIsRefused) {
  const std::vector<std::pair<std::string, std::string>> calls{
      {"convert cube.ply -", "--output-format must be obj, off, ply, stl or glb"},
      {"convert cube.ply - --output-format json", "--output-format must be obj"},
      {"convert cube.ply - --output-format obj --json", "--json"},
      {"detect cube.ply -o - --preview -", "one file only"}};
  for (const auto& [call, words] : calls) {
    const ProgramResult result = run("$orbifit " + call);
    EXPECT_EQ(result.code, 2) << call;
    EXPECT_NE(result.errors.find(words), std::string::npos) << call << "\n" << result.errors;
    EXPECT_EQ(result.output, "") << call;
  }
  EXPECT_EQ(run("$orbifit info - </dev/null").code, 3);
  EXPECT_NE(run("$orbifit check - - <cube.ply").errors.find("standard input: is empty, or was read before"),
            std::string::npos);
}

TEST_F(Manners, UpIsStoredAndOverridden) {
  EXPECT_EQ(run("$orbifit detect cube.ply -o up.json --up -x").code, 0);
  const std::optional<Eigen::Vector3d> up = read_annotation(file("up.json"), cube_).up;
  ASSERT_TRUE(up);
  EXPECT_EQ(*up, -Eigen::Vector3d::UnitX());
  EXPECT_EQ(run("$orbifit detect cube.ply -o none.json").code, 0);
  EXPECT_FALSE(read_annotation(file("none.json"), cube_).up);
  const auto picture = [&](const std::string& options) {
    EXPECT_EQ(run("$orbifit render cube.ply --width 40 --height 30 -o a.png " + options).code, 0) << options;
    return read_file(file("a.png"));
  };
  EXPECT_TRUE(picture("--up y") == picture("--up 0 1 0"));
  EXPECT_TRUE(picture("--up=y") == picture("--up 0 1 0"));
  EXPECT_TRUE(picture("--annotation up.json") == picture("--annotation none.json --up -x"));
  EXPECT_EQ(run("$orbifit render cube.ply -o a.png --up w").code, 2);
}

// Every link of a page leads to a file, and what was printed stays in columns.
TEST_F(Manners, AReportLinksToWhatIsThere) {
  shell_.folder().write("steps.json", R"({"title": "Steps", "sections": [{"title": "Check", "command": "orbifit check",
    "output": "  region  name\n       0  all\nDone.\n", "files": ["cube.json", "cube.ply"],
    "regions": {"mesh": "cube.ply", "annotation": "cube.json"}}]})");
  std::filesystem::create_directory(file("pages"));
  ASSERT_EQ(run("$orbifit report steps.json -o pages/index.html").code, 0);
  const std::string page = read_file(file("pages/index.html"));
  int links = 0;
  for (std::size_t at = page.find("href=\""); at != std::string::npos; at = page.find("href=\"", at + 1)) {
    const std::string target = page.substr(at + 6, page.find('"', at + 6) - at - 6);
    if (target.starts_with('#')) continue;
    EXPECT_TRUE(std::filesystem::exists(file("pages/" + target))) << target;
    ++links;
  }
  EXPECT_EQ(links, 2);
  EXPECT_NE(page.find("<pre class=\"command\">orbifit check</pre>"), std::string::npos);
  EXPECT_NE(page.find("<b>region 0  Oh: all of it</b>"), std::string::npos);
  shell_.folder().write("steps.json", R"({"sections": [{"files": ["none.json"]}]})");
  const ProgramResult refused = run("$orbifit report steps.json -o pages/index.html");
  EXPECT_EQ(refused.code, 3);
  EXPECT_NE(refused.errors.find("sections[0].files[0]: \"none.json\" is no file"), std::string::npos) << refused.errors;
}

TEST_F(Manners, APreviewIsAPageToo) {
  ASSERT_EQ(run("$orbifit detect cube.ply --preview regions.html").code, 0);
  EXPECT_NE(read_file(file("regions.html")).find("<b>region 0  Oh"), std::string::npos);
}

}  // namespace
}  // namespace orbifit

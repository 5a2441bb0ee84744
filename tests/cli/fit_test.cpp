#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "orbifit/model/annotation_io.h"
#include "orbifit/model/mesh_io.h"

#include "files/file.h"
#include "program.h"

namespace orbifit {
namespace {

using nlohmann::json;

class OrbifitFit : public testing::Test {
 protected:
  void SetUp() override {
    run("generate table -o . --quiet");
    run("generate table --param width=1 -o wide --quiet");
    run("scan wide/table.ply -o scan.ply --quiet");
  }

  std::filesystem::path file(const std::string& name) const { return program_.folder().file(name); }

  std::string run(const std::string& line) const {
    const ProgramResult result = program_.run(line);
    EXPECT_EQ(result.code, 0) << line << "\n" << result.errors;
    return result.output;
  }

  Program program_;
  std::string fit_ = "fit table.ply scan.ply --annotation table.annotation.json --aligned --quiet ";
};

TEST_F(OrbifitFit, SaysOfEachGroupWhatTheScanSaysOfIt) {
  run(fit_ + "-o fitted.ply --report report.json --html page.html --annotation-out fitted.json");
  const json report = json::parse(read_file(file("report.json")));
  const SymmetryAnnotation annotation = read_annotation(file("fitted.json"), read_mesh(file("fitted.ply")));
  ASSERT_EQ(report["groups"].size(), annotation.regions.size());
  for (const json& group : report["groups"]) EXPECT_EQ(group["disagrees"], false) << group;
  EXPECT_GT(report["confidence"], 0.9);
  EXPECT_EQ(report["torn_off"], 0);
  EXPECT_GT(report["seconds"]["subspace"], 0);
  const std::string page = read_file(file("page.html"));
  EXPECT_NE(page.find("Symmetry groups and the scan"), std::string::npos);
  EXPECT_EQ(page.find("://"), std::string::npos);
}

TEST_F(OrbifitFit, SaysWhichResolutionsWereTried) {
  run(fit_ + "-o fitted.ply --report report.json");
  const json report = json::parse(read_file(file("report.json")));
  ASSERT_GE(report["resolutions"].size(), 1U);
  EXPECT_EQ(report["resolutions"][0]["kept"], true);
  const json* last = nullptr;
  for (const json& each : report["resolutions"]) {
    if (&each != &report["resolutions"][0]) {
      EXPECT_GT(each["held_out_rms_before"], 0);
      EXPECT_GT(each["held_out_rms"], 0);
    }
    if (each["kept"]) last = &each;
  }
  EXPECT_EQ((*last)["degrees_of_freedom"], report["degrees_of_freedom"]);
  run(fit_ + "-o fitted.ply --report report.json --refinements 0");
  EXPECT_EQ(json::parse(read_file(file("report.json")))["resolutions"].size(), 1U);
  run(fit_ + "-o fitted.ply --report report.json --samples 200");
  EXPECT_EQ(json::parse(read_file(file("report.json")))["resolutions"].size(), 0U);
}

TEST_F(OrbifitFit, SaysWhatDetailItHasAdded) {
  run(fit_ + "-o fitted.ply --report report.json");
  EXPECT_EQ(json::parse(read_file(file("report.json")))["detail"]["levels"].size(), 0U);
  run(fit_ + "-o detailed.ply --report report.json --html report.html --refinements 0 --samples 60 --detail");
  const json report = json::parse(read_file(file("report.json")));
  ASSERT_GT(report["detail"]["levels"].size(), 0U);
  EXPECT_EQ(report["detail"]["levels"][0]["kept"], true);
  EXPECT_GT(report["detail"]["levels"][0]["held_out_rms_before"], report["detail"]["levels"][0]["held_out_rms"]);
  EXPECT_GT(report["detail"]["rms"], 0);
  EXPECT_LT(report["symmetry"]["field_residual"], 1e-12);
  EXPECT_NE(read_file(file("report.html")).find("Detail"), std::string::npos);
}

TEST_F(OrbifitFit, LeavesOutTheGroupsThatAreNamed) {
  const SymmetryAnnotation before = read_annotation(file("table.annotation.json"), read_mesh(file("table.ply")));
  const int whole = before.regions.front().id;
  run(fit_ + "-o fitted.ply --annotation-out fitted.json --without " + std::to_string(whole));
  const SymmetryAnnotation after = read_annotation(file("fitted.json"), read_mesh(file("fitted.ply")));
  EXPECT_EQ(after.regions.size(), before.regions.size() - 1);
  for (const Region& region : after.regions) EXPECT_NE(region.id, whole);
}

TEST_F(OrbifitFit, WritesNoMeshAboveTheLargestResidualAsked) {
  const std::string spoken = "fit table.ply scan.ply --annotation table.annotation.json --aligned ";
  EXPECT_NE(run(spoken + "-o fitted.ply --max-residual 1e-9").find("symmetric to "), std::string::npos);
  EXPECT_TRUE(std::filesystem::exists(file("fitted.ply")));
  const ProgramResult refused = program_.run(fit_ + "-o rough.ply --lift paper --max-residual 1e-9");
  EXPECT_EQ(refused.code, 1);
  EXPECT_NE(refused.errors.find("no mesh was written"), std::string::npos) << refused.errors;
  EXPECT_FALSE(std::filesystem::exists(file("rough.ply")));
}

TEST_F(OrbifitFit, RelaxesNothingThatTheScanHas) {
  const json report = json::parse(run(fit_ + "-o fitted.ply --drop-unsupported --json"));
  EXPECT_EQ(report["relaxed"], json::array());
}

TEST_F(OrbifitFit, SaysHowManyOfManyPointsAreUsed) {
  const ProgramResult result = program_.run(
      "fit table.ply scan.ply --annotation table.annotation.json --aligned --scan-points 500 -o fitted.ply");
  EXPECT_EQ(result.code, 0) << result.errors;
  EXPECT_NE(result.errors.find("scan.ply: 500 of its "), std::string::npos) << result.errors;
}

TEST_F(OrbifitFit, TakesAViewpoint) {
  run("convert scan.ply bare.xyz --quiet");
  const std::string bare =
      "fit table.ply bare.xyz --annotation table.annotation.json --aligned --quiet --json -o f.ply";
  EXPECT_EQ(json::parse(run(bare))["covered"], 1);
  EXPECT_LT(json::parse(run(bare + " --viewpoint 2 -2 2"))["covered"], 1);
}

class OrbifitCompare : public OrbifitFit {};

TEST_F(OrbifitCompare, WritesATableAPageAndTheMeshes) {
  const std::string line =
      "compare table.ply scan.ply --annotation table.annotation.json --truth wide/table.ply --aligned --samples 80 "
      "--methods ours,none,similarity --brief --quiet --json -o all";
  const json table = json::parse(run(line));
  ASSERT_EQ(table["methods"].size(), 3U);
  EXPECT_LT(table["methods"][0]["symmetry_residual"], 1e-9);
  EXPECT_GT(table["methods"][1]["symmetry_residual"], 1e-4);
  EXPECT_LT(table["methods"][0]["hidden"], table["methods"][2]["hidden"]);
  for (const char* name :
       {"comparison.csv", "comparison.json", "comparison.txt", "index.html", "ours.ply", "none.ply"}) {
    EXPECT_TRUE(std::filesystem::exists(file("all") / name)) << name;
  }
  EXPECT_EQ(read_mesh(file("all") / "ours.ply").faces, read_mesh(file("table.ply")).faces);
}

TEST_F(OrbifitCompare, EditsByHandlesThatContradictTheSymmetry) {
  write_file(file("handles.json"),
             R"({"handles": [{"centre": [0.6, 0, 0.7], "radius": 0.2, "translation": [0.1, 0, 0.05]},
                             {"centre": [-0.6, 0, 0.7], "radius": 0.2}]})");
  const json table =
      json::parse(run("compare table.ply --annotation table.annotation.json --handles handles.json --samples 80 "
                      "--methods ours,none,similarity --brief --quiet --json -o edited"));
  ASSERT_EQ(table["methods"].size(), 3U);
  EXPECT_LT(table["methods"][0]["symmetry_residual"], 1e-9);
  EXPECT_GT(table["methods"][1]["symmetry_residual"], 1e-3);
  EXPECT_LT(table["methods"][1]["handle_error"], table["methods"][0]["handle_error"]);
  EXPECT_GT(table["methods"][0]["bending"], 1e-3);
  EXPECT_LT(table["methods"][2]["bending"], 1e-6);
}

}  // namespace
}  // namespace orbifit

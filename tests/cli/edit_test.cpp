#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "orbifit/model/annotation_io.h"
#include "orbifit/model/mesh_io.h"

#include "cube.h"
#include "program.h"

namespace orbifit {
namespace {

using nlohmann::json;

// What `deform` says of an edit.
class OrbifitDeform : public testing::Test {
 protected:
  void SetUp() override {
    write_mesh(file("cube.ply"), cube_);
    write_annotation(file("cube.json"), cube_annotation(cube_));
  }

  std::filesystem::path file(const std::string& name) const { return program_.folder().file(name); }

  ProgramResult deform(const std::string& handles, const std::string& options = "") const {
    program_.folder().write("handles.json", R"({"handles": [)" + handles + "]}");
    std::filesystem::remove(file("out.ply"));
    return program_.run("deform cube.ply cube.json --handles handles.json -o out.ply " + options);
  }

  json warnings(const std::string& handles, const std::string& options = "") const {
    const ProgramResult result = deform(handles, "--json --quiet " + options);
    EXPECT_EQ(result.code, 0) << result.errors;
    return json::parse(result.output)["warnings"];
  }

  Program program_;
  Mesh cube_ = cube_mesh();
  std::string right_ = R"({"name": "right", "centre": [0.5, 0, 0], "radius": 0.3)";
  std::string left_ = R"({"name": "left", "centre": [-0.5, 0, 0], "radius": 0.3)";
};

TEST_F(OrbifitDeform, NamesTheRegionThatForbidsAnEdit) {
  // One side up, the other held: no group of the cube's has that, however it is carried along.
  const std::string handles = right_ + R"(, "translation": [0, 0.2, 0]}, )" + left_ + "}";
  for (const char* mode : {"fixed", "floating"}) {
    const std::string options = "--mode " + std::string(mode);
    const ProgramResult result = deform(handles, options);
    EXPECT_EQ(result.code, 0) << result.errors;
    EXPECT_NE(result.errors.find("handle \"right\" misses its target"), std::string::npos) << result.errors;
    EXPECT_NE(result.errors.find("region 0 (Oh, \"cube\") forbids this; leave it out with --without 0"),
              std::string::npos)
        << result.errors;
    EXPECT_EQ(warnings(handles, options + " --without 0"), json::array());
  }
}

TEST_F(OrbifitDeform, WarnsOfNothingWhereAllGoesAsAsked) {
  const std::string handles =
      right_ + R"(, "translation": [0.1, 0, 0]}, )" + left_ + R"(, "translation": [-0.1, 0, 0]})";
  EXPECT_EQ(warnings(handles), json::array());
  EXPECT_EQ(warnings(right_ + "}"), json::array()) << "nothing is asked";
  const ProgramResult result = deform(handles);
  EXPECT_EQ(result.errors, "");
  EXPECT_NE(result.output.find("symmetric to "), std::string::npos) << result.output;
}

TEST_F(OrbifitDeform, SaysThatTheShapeWasOnlyMoved) {
  const json said = warnings(right_ + R"(, "translation": [0, 0.2, 0]})");
  ASSERT_EQ(said.size(), 1U) << said;
  EXPECT_NE(said[0].get<std::string>().find("hold something"), std::string::npos) << said;
}

TEST_F(OrbifitDeform, SaysHowFarAHandleIsFromTheMesh) {
  const ProgramResult result = deform(R"({"name": "far", "centre": [2.5, 0, 0], "radius": 0.5})");
  EXPECT_EQ(result.code, 3);
  EXPECT_NE(result.errors.find("\"far\": takes no vertex of the mesh: the nearest, "), std::string::npos)
      << result.errors;
  EXPECT_NE(result.errors.find("at 0.5 0 0, is 2 from the centre, the radius is 0.5"), std::string::npos)
      << result.errors;
}

TEST_F(OrbifitDeform, WritesNothingAboveTheLargestResidualAsked) {
  const std::string handles = right_ + R"(, "translation": [0.1, 0, 0]})";
  EXPECT_EQ(deform(handles, "--max-residual 1e-9").code, 0);
  EXPECT_TRUE(std::filesystem::exists(file("out.ply")));
  // The paper's lift is not exact on a part of the surface.
  SymmetryAnnotation part = cube_annotation(cube_);
  part.regions[0] =
      make_region(*PointGroup::parse("C4v"), {0.5, 0, 0}, frame_about(Eigen::Vector3d::UnitX()), {}, "side");
  for (int f = 0; f < cube_.faces.rows(); ++f) {
    if (face_normal(cube_, f).x() > 0.5) part.regions[0].faces.push_back(f);
  }
  write_annotation(file("cube.json"), part);
  const std::string corner =
      left_ + R"(}, {"name": "corner", "centre": [0.5, 0.5, 0.5], "radius": 0.3, "translation": [0, 0.1, 0]})";
  const ProgramResult warned = deform(corner, "--lift paper");
  EXPECT_EQ(warned.code, 0) << warned.errors;
  EXPECT_NE(warned.errors.find("warning: the edit is only symmetric to "), std::string::npos) << warned.errors;
  const ProgramResult refused = deform(corner, "--lift paper --max-residual 1e-9 --annotation-out out.json");
  EXPECT_EQ(refused.code, 1);
  EXPECT_NE(refused.errors.find("above --max-residual 1e-09; nothing was written"), std::string::npos)
      << refused.errors;
  EXPECT_FALSE(std::filesystem::exists(file("out.ply")));
  EXPECT_FALSE(std::filesystem::exists(file("out.json")));
  const ProgramResult as_json = deform(corner, "--lift paper --max-residual 1e-9 --json --quiet");
  EXPECT_EQ(as_json.code, 1);
  EXPECT_EQ(json::parse(as_json.output)["written"], false);
  EXPECT_EQ(deform(handles, "--max-residual -1").code, 2);
}

TEST_F(OrbifitDeform, LeavesRegionsOutInEveryCommandThatKeepsThem) {
  SymmetryAnnotation two = cube_annotation(cube_);
  two.regions.push_back(two.regions[0]);
  two.regions[1] =
      make_region(*PointGroup::parse("C4v"), {0.5, 0, 0}, frame_about(Eigen::Vector3d::UnitX()), {}, "side");
  two.regions[1].id = 7;
  for (int f = 0; f < cube_.faces.rows(); ++f) {
    if (face_normal(cube_, f).x() > 0.5) two.regions[1].faces.push_back(f);
  }
  set_parents(two.regions);
  write_annotation(file("cube.json"), two);
  const auto regions_of = [&](const std::string& line) {
    const ProgramResult result = program_.run(line + " --without 0 --json --quiet");
    EXPECT_EQ(result.code, 0) << line << result.errors;
    const json report = json::parse(result.output);
    return report["regions"];
  };
  for (const char* line : {"subspace cube.ply cube.json", "symmetrize cube.ply cube.json -o exact.ply"}) {
    const json regions = regions_of(line);
    ASSERT_EQ(regions.size(), 1U) << line;
    EXPECT_EQ(regions[0]["id"], 7) << line;
    EXPECT_EQ(program_.run(std::string(line) + " --without 3").code, 2) << line;
  }
  ASSERT_EQ(deform(right_ + "}", "--without 0 --annotation-out out.json").code, 0);
  const SymmetryAnnotation kept = read_annotation(file("out.json"), cube_);
  ASSERT_EQ(kept.regions.size(), 1U);
  EXPECT_EQ(kept.regions[0].id, 7);
  EXPECT_FALSE(kept.regions[0].parent);
}

TEST_F(OrbifitDeform, APageToEditInIsMadeWithTheSameBasis) {
  const auto page = [&](const std::string& options) {
    const ProgramResult result = program_.run("edit cube.ply cube.json -o page.html --json --quiet " + options);
    EXPECT_EQ(result.code, 0) << result.errors;
    return json::parse(result.output);
  };
  const json usual = page("");
  EXPECT_EQ(usual["regions"], 1);
  EXPECT_EQ(page("--without 0")["regions"], 0);
  const json coarse = page("--samples 500 --mode fixed");
  EXPECT_LT(coarse["samples"], usual["samples"]);
  const ProgramResult basis = program_.run("subspace cube.ply cube.json --samples 500 --mode fixed --json --quiet");
  ASSERT_EQ(basis.code, 0) << basis.errors;
  EXPECT_EQ(coarse["samples"], json::parse(basis.output)["samples"]);
  EXPECT_EQ(coarse["degrees_of_freedom"], json::parse(basis.output)["degrees_of_freedom"]);
  program_.folder().write("field.json", R"({"areas": [{"centre": [0.5, 0.5, 0.5], "radius": 0.3, "factor": 0.5}]})");
  const ProgramResult field =
      program_.run("subspace cube.ply cube.json --radius-field field.json --samples 500 --json --quiet");
  ASSERT_EQ(field.code, 0) << field.errors;
  EXPECT_EQ(page("--radius-field field.json --samples 500")["samples"], json::parse(field.output)["samples"]);
  EXPECT_NE(json::parse(field.output)["samples"], page("--samples 500")["samples"]);
  EXPECT_EQ(program_.run("edit cube.ply cube.json -o page.html --radius-field page.html").code, 2);
  EXPECT_EQ(program_.run("edit cube.ply cube.json -o page.html --radius-field cube.ply").code, 3);
  EXPECT_EQ(program_.run("edit cube.ply cube.json -o page.html --without 3").code, 2);
  EXPECT_EQ(program_.run("edit cube.ply cube.json -o page.html --radius -1").code, 2);
}

}  // namespace
}  // namespace orbifit

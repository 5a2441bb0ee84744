#include <cmath>
#include <filesystem>
#include <fstream>
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

class OrbifitSymmetrize : public testing::Test {
 protected:
  void SetUp() override {
    // Noise as a function of the place, so that coincident vertices stay so.
    for (Eigen::Index v = 0; v < rough_.vertices.rows(); ++v) {
      const Eigen::RowVector3d p = rough_.vertices.row(v);
      rough_.vertices.row(v) += 2e-3 * Eigen::RowVector3d(std::sin(31 * p[1] + 7), std::sin(29 * p[2] + 3),
                                                          std::sin(37 * p[0] + 23 * p[1] + 1));
    }
    write_mesh(file("rough.ply"), rough_);
    write_annotation(file("cube.json"), cube_annotation(rough_));
  }

  std::filesystem::path file(const std::string& name) const { return program_.folder().file(name); }

  Program program_;
  Mesh rough_ = cube_mesh();
};

TEST_F(OrbifitSymmetrize, MakesWhatCheckFindsExact) {
  EXPECT_EQ(program_.run("check rough.ply cube.json --max-residual 1e-3").code, 1);
  const ProgramResult result =
      program_.run("symmetrize rough.ply cube.json -o exact.ply --annotation-out exact.json --json");
  ASSERT_EQ(result.code, 0) << result.errors;
  const json report = json::parse(result.output);
  EXPECT_EQ(report["vertices_onto_vertices"], true);
  EXPECT_LT(report["residual"], 1e-12);
  EXPECT_EQ(report["mapped"], rough_.vertices.rows());
  EXPECT_GT(report["regions"][0]["before"]["max"], 1e-3);
  EXPECT_GT(report["largest_movement"], 1e-4);
  EXPECT_EQ(read_mesh(file("exact.ply")).faces, rough_.faces);
  EXPECT_EQ(program_.run("check exact.ply cube.json --max-residual 1e-12").code, 0);
  EXPECT_EQ(program_.run("check exact.ply exact.json --max-residual 1e-12").code, 0);
  const SymmetryAnnotation written = read_annotation(file("exact.json"), read_mesh(file("exact.ply")));
  EXPECT_LT(written.regions.front().residual.max, 1e-12);
}

TEST_F(OrbifitSymmetrize, SaysWhatItDid) {
  const ProgramResult result = program_.run("symmetrize rough.ply cube.json -o exact.obj");
  EXPECT_EQ(result.code, 0) << result.errors;
  EXPECT_NE(result.output.find("exactly symmetric"), std::string::npos) << result.output;
  EXPECT_NE(result.output.find("Oh"), std::string::npos) << result.output;
}

TEST_F(OrbifitSymmetrize, RefusesWhatItCannotUse) {
  EXPECT_EQ(program_.run("symmetrize rough.ply cube.json").code, 2);
  EXPECT_EQ(program_.run("symmetrize rough.ply missing.json -o exact.ply").code, 3);
  EXPECT_EQ(program_.run("symmetrize rough.ply cube.json -o exact.xyz").code, 2);
  EXPECT_EQ(program_.run("symmetrize rough.ply cube.json -o cube.json").code, 2);
  EXPECT_EQ(program_.run("symmetrize rough.ply cube.json -o exact.ply --annotation-out exact.txt").code, 2);
}

TEST_F(OrbifitSymmetrize, RemeshesSoThatTrianglesMapOntoTriangles) {
  const ProgramResult result =
      program_.run("symmetrize rough.ply cube.json -o new.ply --remesh --annotation-out new.json --report moved.json");
  ASSERT_EQ(result.code, 0) << result.errors;
  EXPECT_NE(result.output.find("vertices map onto vertices"), std::string::npos) << result.output;
  const ProgramResult checked = program_.run("check new.ply new.json --max-residual 1e-12 --json");
  EXPECT_EQ(checked.code, 0);
  EXPECT_EQ(json::parse(checked.output)["vertices_onto_vertices"], true);
  std::ifstream stream(file("moved.json"));
  const json report = json::parse(stream);
  EXPECT_GT(report["largest_movement"], 1e-4);
  EXPECT_GE(report["largest_movement"], report["mean_movement"]);
  EXPECT_EQ(report["regions"][0]["kept_as"], "Oh");
  EXPECT_EQ(json::parse(program_.run("info new.ply --json").output)["watertight"], true);
  EXPECT_EQ(program_.run("symmetrize rough.ply cube.json -o again.ply --remesh --threads 2").code, 0);
  EXPECT_EQ(read_mesh(file("again.ply")).vertices, read_mesh(file("new.ply")).vertices);
}

TEST_F(OrbifitSymmetrize, RefusesToForceASymmetry) {
  Mesh other = rough_;
  other.vertices.col(2) *= 1.3;
  write_mesh(file("other.ply"), other);
  SymmetryAnnotation annotation = cube_annotation(rough_);
  annotation.mesh_diagonal = diagonal(other.vertices);
  write_annotation(file("other.json"), annotation);
  const ProgramResult refused = program_.run("symmetrize other.ply other.json -o x.ply --remesh --min-score 0.95");
  EXPECT_EQ(refused.code, 1) << refused.errors;
  EXPECT_NE(refused.errors.find("95 %"), std::string::npos) << refused.errors;
  EXPECT_FALSE(std::filesystem::exists(file("x.ply")));
  EXPECT_EQ(program_.run("symmetrize other.ply other.json -o x.ply --min-score 0.5").code, 2);
  EXPECT_EQ(program_.run("symmetrize other.ply other.json -o x.ply --remesh --min-score 2").code, 2);
  EXPECT_EQ(program_.run("symmetrize other.ply other.json -o x.ply --remesh --report other.json").code, 2);
}

}  // namespace
}  // namespace orbifit

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

// A cube and, apart from it, a smaller one that is askew: what is symmetric about the first cube's axes is the cube.
Mesh two_cubes() {
  Mesh mesh = cube_mesh();
  const Mesh small = cube_mesh(2);
  const Eigen::Matrix3d askew = axis_rotation(Eigen::Vector3d(0.48, 0.6, 0.64), 0.7);
  const auto first = static_cast<int>(mesh.vertices.rows());
  const Eigen::Index faces = mesh.faces.rows();
  mesh.vertices.conservativeResize(first + small.vertices.rows(), 3);
  mesh.vertices.bottomRows(small.vertices.rows()) =
      (0.4 * small.vertices * askew.transpose()).rowwise() + Eigen::RowVector3d(1.3, 0.4, 0.9);
  mesh.faces.conservativeResize(faces + small.faces.rows(), 3);
  mesh.faces.bottomRows(small.faces.rows()) = small.faces.array() + first;
  return mesh;
}

class OrbifitAnnotate : public testing::Test {
 protected:
  void SetUp() override {
    write_mesh(file("cubes.ply"), mesh_);
    write_mesh(file("other.ply"), cube_mesh(3));
  }

  std::filesystem::path file(const std::string& name) const { return program_.folder().file(name); }
  SymmetryAnnotation annotation(const std::string& name) const { return read_annotation(file(name), mesh_); }

  Program program_;
  Mesh mesh_ = two_cubes();
  int cube_faces_ = static_cast<int>(cube_mesh().faces.rows());
};

struct Place {
  std::string name, arguments, group;
};

class AnnotatedCube : public OrbifitAnnotate, public testing::WithParamInterface<Place> {};

TEST_P(AnnotatedCube, IsFittedFromARoughPlace) {
  const ProgramResult result =
      program_.run("annotate cubes.ply -o out.json --seed-face 5 --json " + GetParam().arguments);
  ASSERT_EQ(result.code, 0) << result.errors;
  const json report = json::parse(result.output);
  EXPECT_EQ(report["group"], GetParam().group);
  EXPECT_EQ(report["faces"], cube_faces_);
  EXPECT_LT(report["residual"]["max"], 1e-6);
  const SymmetryAnnotation written = annotation("out.json");
  ASSERT_EQ(written.regions.size(), 1U);
  EXPECT_EQ(written.regions[0].group.symbol(), GetParam().group);
  if (GetParam().group != "Cs") {
    EXPECT_LT(written.regions[0].centre.cross(written.regions[0].axis).norm(), 1e-6);
  }
  EXPECT_EQ(program_.run("check cubes.ply out.json --max-residual 1e-6").code, 0);
}

INSTANTIATE_TEST_SUITE_P(Places, AnnotatedCube,
                         testing::Values(Place{"Plane", "--plane 0.01 0.2 0.3 1 0.02 0", "Cs"},
                                         Place{"DiagonalPlane", "--plane 0 0.01 0 1 1.03 0.01", "Cs"},
                                         Place{"Centre", "--centre 0.01 0 -0.01", "Ci"},
                                         Place{"Largest", "--axis 0.01 0 0 0.02 0 1 --order 4", "Oh"},
                                         Place{"AnyOrder", "--axis 0.004 0 0 0.01 0 1", "Oh"},
                                         Place{"Asked", "--axis 0.01 0 0.2 0.02 0 1 --group C4", "C4"},
                                         Place{"Mirrors", "--axis 0.01 0 0.2 0.02 0 1 --group C4v", "C4v"},
                                         Place{"Diagonal", "--axis 0.01 0 0 1 1.02 1 --group D3d", "D3d"},
                                         Place{"Solid", "--centre 0 0 0.01 --group Td", "Td"}),
                         [](const auto& test) { return test.param.name; });

TEST_F(OrbifitAnnotate, AddsToAnAnnotationInTheDetectorsOrder) {
  ASSERT_EQ(
      program_
          .run("annotate cubes.ply -o small.json --centre 1.3 0.4 0.9 --seed-face " + std::to_string(cube_faces_ + 3))
          .code,
      0);
  const ProgramResult result = program_.run(
      "annotate cubes.ply -o both.json --annotation small.json --plane 0 0 0 0 0 1 --seed-face 0 --name large");
  ASSERT_EQ(result.code, 0) << result.errors;
  const SymmetryAnnotation both = annotation("both.json");
  ASSERT_EQ(both.regions.size(), 2U);
  EXPECT_EQ(both.regions[0].name, "large");
  EXPECT_EQ(both.regions[0].id, 0);
  EXPECT_EQ(both.regions[1].group.symbol(), "Ci");
  EXPECT_EQ(both.regions[1].id, 1);
  EXPECT_FALSE(both.regions[1].parent);
}

TEST_F(OrbifitAnnotate, RefusesWhatIsSaidAlreadyAndReplacesWhatSaysLess) {
  const std::string mirror = "annotate cubes.ply --plane 0 0 0 0 0 1 --seed-face 0 ";
  ASSERT_EQ(program_.run(mirror + "-o mirror.json").code, 0);
  const ProgramResult again = program_.run(mirror + "-o again.json --annotation mirror.json");
  EXPECT_EQ(again.code, 1);
  EXPECT_NE(again.errors.find("region 0 (Cs"), std::string::npos) << again.errors;
  EXPECT_FALSE(std::filesystem::exists(file("again.json")));
  const ProgramResult larger = program_.run(
      "annotate cubes.ply --axis 0 0 0 0 0 1 --group D4h --seed-face 0 -o larger.json --annotation mirror.json");
  ASSERT_EQ(larger.code, 0) << larger.errors;
  EXPECT_NE(larger.output.find("in place of region 0 (Cs"), std::string::npos) << larger.output;
  EXPECT_EQ(annotation("larger.json").regions.size(), 1U);
}

TEST_F(OrbifitAnnotate, SaysWhatDoesNotFitAndWritesNothing) {
  for (const char* place : {"--axis 0 0 0 0 0 1 --order 5", "--axis 0 0 0 0 0 1 --order inf",
                            "--plane 0.2 0 0 1 0 0 --no-refine", "--plane 0 0 0 1 0.4 0"}) {
    const ProgramResult result = program_.run("annotate cubes.ply -o out.json --seed-face 0 " + std::string(place));
    EXPECT_EQ(result.code, 1) << place;
    EXPECT_NE(result.errors.find("does not hold"), std::string::npos) << result.errors;
    EXPECT_NE(result.errors.find("residual"), std::string::npos) << result.errors;
    EXPECT_FALSE(std::filesystem::exists(file("out.json"))) << place;
  }
}

TEST_F(OrbifitAnnotate, TakesAPlaneAsItIsGiven) {
  ASSERT_EQ(program_.run("annotate cubes.ply -o out.json --seed-face 0 --no-refine --plane 0.001 0 0 1 0 0").code, 0);
  EXPECT_DOUBLE_EQ(annotation("out.json").regions[0].centre.x(), 0.001);
}

TEST_F(OrbifitAnnotate, SaysAtWhichToleranceARejectedRegionWouldPass) {
  const std::string line =
      "annotate cubes.ply -o out.json --seed-face 0 --no-refine --plane 0.01 0 0 1 0 0 --tolerance ";
  const ProgramResult refused = program_.run(line + "0.002");
  EXPECT_EQ(refused.code, 1);
  EXPECT_NE(refused.errors.find("fits, at least 96 % must"), std::string::npos) << refused.errors;
  const std::string advice = "it would pass with --tolerance ";
  const std::size_t at = refused.errors.find(advice);
  ASSERT_NE(at, std::string::npos) << refused.errors;
  const std::string tolerance =
      refused.errors.substr(at + advice.size(), refused.errors.find(';', at) - at - advice.size());
  EXPECT_EQ(program_.run(line + tolerance).code, 0) << tolerance;
}

TEST_F(OrbifitAnnotate, TakesTheFaceNearestToAPoint) {
  const std::string place = "--group C4 --axis 1.3 0.4 0.9 ";
  const Eigen::Vector3d axis = axis_rotation(Eigen::Vector3d(0.48, 0.6, 0.64), 0.7).col(2);
  const std::string direction =
      std::to_string(axis.x()) + " " + std::to_string(axis.y()) + " " + std::to_string(axis.z()) + " ";
  const ProgramResult result = program_.run("annotate cubes.ply -o out.json --near 1.3 0.4 1.2 " + place + direction);
  ASSERT_EQ(result.code, 0) << result.errors;
  const SymmetryAnnotation found = annotation("out.json");
  ASSERT_EQ(found.regions.size(), 1U);
  EXPECT_EQ(found.regions[0].faces.front(), cube_faces_) << "the small cube, which follows the large one";
}

TEST_F(OrbifitAnnotate, ListsRemovesAndRenames) {
  SymmetryAnnotation three = empty_annotation(mesh_, 0.005);
  std::vector<int> faces(static_cast<std::size_t>(cube_faces_));
  for (std::size_t f = 0; f < faces.size(); ++f) faces[f] = static_cast<int>(f);
  for (const int count : {cube_faces_, cube_faces_ / 6, cube_faces_ / 12}) {
    Region region = make_region({PointGroup::Family::Cs, 1}, Eigen::Vector3d::Zero(), Eigen::Matrix3d::Identity(),
                                {faces.begin(), faces.begin() + count}, "part of " + std::to_string(count));
    region.id = static_cast<int>(three.regions.size());
    three.regions.push_back(region);
  }
  set_parents(three.regions);
  ASSERT_EQ(three.regions[2].parent, 1);
  write_annotation(file("three.json"), three);
  const std::string call = "annotate cubes.ply --annotation three.json ";
  const ProgramResult list = program_.run(call + "--list");
  EXPECT_EQ(list.code, 0) << list.errors;
  for (const Region& region : three.regions) EXPECT_NE(list.output.find(region.name), std::string::npos) << list.output;

  const ProgramResult edited = program_.run(call + "--remove 1 --rename 2 small -o edited.json --json");
  ASSERT_EQ(edited.code, 0) << edited.errors;
  const json report = json::parse(edited.output);
  EXPECT_EQ(report["changes"].size(), 2U);
  ASSERT_EQ(report["regions"].size(), 2U);
  const SymmetryAnnotation rest = annotation("edited.json");
  ASSERT_EQ(rest.regions.size(), 2U);
  EXPECT_EQ(rest.regions[0].id, 0);
  EXPECT_EQ(rest.regions[1].id, 2);
  EXPECT_EQ(rest.regions[1].name, "small");
  EXPECT_EQ(rest.regions[1].parent, 0);

  ASSERT_EQ(program_.run(call + "--remove 0,1,2 -o none.json").code, 0);
  EXPECT_TRUE(annotation("none.json").regions.empty());
  EXPECT_EQ(program_.run(call + "--list").output, list.output) << "without -o nothing is written";
}

struct Bad {
  std::string name, arguments;
  int code;
  std::string message;
};

class BadAnnotate : public OrbifitAnnotate, public testing::WithParamInterface<Bad> {};

TEST_P(BadAnnotate, IsRefused) {
  ASSERT_EQ(program_.run("annotate cubes.ply -o old.json --plane 0 0 0 0 0 1 --seed-face 0").code, 0);
  const ProgramResult result = program_.run("annotate " + GetParam().arguments + " -o out.json");
  EXPECT_EQ(result.code, GetParam().code) << result.errors;
  EXPECT_NE(result.errors.find(GetParam().message), std::string::npos) << result.errors;
  EXPECT_EQ(result.output, "");
  EXPECT_FALSE(std::filesystem::exists(file("out.json")));
}

INSTANTIATE_TEST_SUITE_P(
    Input, BadAnnotate,
    testing::Values(
        Bad{"FaceTooHigh", "cubes.ply --plane 0 0 0 0 0 1 --seed-face 480", 2, "the seed face is 480"},
        Bad{"FaceNegative", "cubes.ply --plane 0 0 0 0 0 1 --seed-face -1", 2, "the seed face is -1"},
        Bad{"NoFace", "cubes.ply --plane 0 0 0 0 0 1", 2, "a face of the region is needed"},
        Bad{"ZeroDirection", "cubes.ply --plane 0 0 0 0 0 0 --seed-face 0", 2, "the direction is 0 0 0"},
        Bad{"NotFinite", "cubes.ply --axis 0 nan 0 0 0 1 --seed-face 0", 2, "is not finite"},
        Bad{"NoPlace", "cubes.ply --seed-face 0", 2, "one of --plane, --axis and --centre is needed"},
        Bad{"TwoPlaces", "cubes.ply --centre 0 0 0 --plane 0 0 0 0 0 1 --seed-face 0", 2, "no more than one"},
        Bad{"OrderOne", "cubes.ply --axis 0 0 0 0 0 1 --order 1 --seed-face 0", 2, "--order is '1'"},
        Bad{"OrderText", "cubes.ply --axis 0 0 0 0 0 1 --order many --seed-face 0", 2, "--order is 'many'"},
        Bad{"OrderOfPlane", "cubes.ply --plane 0 0 0 0 0 1 --order 2 --seed-face 0", 2, "only an axis has one"},
        Bad{"UnknownGroup", "cubes.ply --axis 0 0 0 0 0 1 --group Q4 --seed-face 0", 2, "--group is 'Q4'"},
        Bad{"GroupOfPlane", "cubes.ply --plane 0 0 0 0 0 1 --group C4 --seed-face 0", 2, "a plane's group is Cs"},
        Bad{"GroupAndOrder", "cubes.ply --axis 0 0 0 0 0 1 --group C4 --order 4 --seed-face 0", 2, "says it already"},
        Bad{"RemoveUnknown", "cubes.ply --annotation old.json --remove 0,4", 2,
            "--remove: the annotation has no region 4"},
        Bad{"RenameUnknown", "cubes.ply --annotation old.json --rename 4 seat", 2,
            "--rename: the annotation has no region 4"},
        Bad{"ListOfNothing", "cubes.ply --list", 2, "--list requires --annotation"},
        Bad{"NearNowhere", "cubes.ply --plane 0 0 0 0 0 1 --near nan 0 0", 2, "--near"},
        Bad{"Tolerance", "cubes.ply --plane 0 0 0 0 0 1 --tolerance 0.5 --seed-face 0", 2, "tolerance"},
        Bad{"OtherMesh", "other.ply --annotation old.json --plane 0 0 0 0 0 1 --seed-face 0", 3,
            "the annotation is of a mesh with"},
        Bad{"NoAnnotation", "cubes.ply --annotation none.json --plane 0 0 0 0 0 1 --seed-face 0", 3,
            "none.json: no such file"}),
    [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace orbifit

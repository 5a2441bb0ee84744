// What takes all stages together, on models of the detection suite.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "orbifit/detection/detect.h"

#include "cases/spoil.h"
#include "group/verification.h"
#include "remeshing/remesh.h"
#include "suite/detection_suite.h"
#include "surface/canonical_pose.h"
#include "surface/surface_patch.h"

namespace orbifit {
namespace {

TruthModel suite_model(const std::string& name) {
  const std::vector<SuiteModel> suite = detection_suite();
  return std::ranges::find(suite, name, &SuiteModel::name)->build();
}

std::ptrdiff_t count_of(const SymmetryAnnotation& annotation, const char* group) {
  return std::ranges::count_if(annotation.regions,
                               [&](const Region& region) { return region.group.symbol() == group; });
}

// Mirrors of some of the windows would stand against the grid of all; they follow from it and from the windows' own.
TEST(DetectSuite, AGridStandsBesideTheMirrorOfTheWallThatKeepsSomeOfIt) {
  const TruthModel model = suite_model("facade");
  RunContext context;
  const SymmetryAnnotation found = detect(model.mesh, {}, context);
  ASSERT_EQ(found.patterns.size(), 1U);
  EXPECT_EQ(found.patterns[0].instances.size(), 20U);
  EXPECT_EQ(found.patterns[0].kind, Pattern::Kind::translation_2d);
  EXPECT_EQ(count_of(found, "Cs"), 1);
  EXPECT_EQ(count_of(found, "C2v"), 0);
}

// Ten columns are turned about their own axes from foot to head, though rings of all ten have more elements.
TEST(DetectSuite, ColumnsDoNotGiveUpTheirShaftsToTheRingOfThem) {
  const TruthModel model = suite_model("rotunda");
  RunContext context;
  const SymmetryAnnotation found = detect(model.mesh, {}, context);
  for (const Region& column : model.truth.expected.regions) {
    const bool is_found = std::ranges::any_of(found.regions, [&](const Region& region) {
      return region.group == column.group && region.faces == column.faces;
    });
    EXPECT_TRUE(is_found) << column.name;
  }
}

// The wheels of two gears in mesh and their pins, beside what mirrors all but the teeth that meet.
TEST(DetectSuite, GearsKeepTheirOwnGroups) {
  const TruthModel model = suite_model("two_gears");
  RunContext context;
  const SymmetryAnnotation found = detect(model.mesh, {}, context);
  for (const char* group : {"C16v", "C10v", "D16h", "D10h"}) EXPECT_EQ(count_of(found, group), 1) << group;
}

// A gear's boss is a part: its own group is named, and not only that of what turns about the axis, gear's faces and
// all.
TEST(DetectSuite, PartsComeBeforeWhatEndsWithinThem) {
  const TruthModel model = suite_model("gear_D12h");
  RunContext context;
  const SymmetryAnnotation found = detect(model.mesh, {}, context);
  for (const Region& part : model.truth.expected.regions) {
    const bool is_found = std::ranges::any_of(
        found.regions, [&](const Region& region) { return region.group == part.group && region.faces == part.faces; });
    EXPECT_TRUE(is_found) << part.name;
  }
}

// What was moved or gave up faces so that all can be kept is measured as it is then.
TEST(DetectSuite, ResidualsAreOfTheFacesAndPlacesThatAreListed) {
  RunContext context;
  // In the order in which it is looked at, so that the same samples are drawn.
  const Mesh mesh = CanonicalPose(remesh(suite_model("yard_tool").mesh, {}, context).mesh).mesh;
  const SymmetryAnnotation found = detect(mesh, {}, context);
  const PreparedMesh prepared = prepare(mesh);
  const SymmetryAnnotation local = transformed(found, inverse(prepared.input_of_normalised));
  int measured = 0;
  for (const Region& region : local.regions) {
    if (region.group.continuous()) continue;
    SCOPED_TRACE(region.name);
    const SurfacePatch patch =
        make_patch(prepared, region.faces, kResidualSamples, found.tolerance, context, "residual");
    const std::vector<Motion> motions(region.elements.begin() + 1, region.elements.end());
    const Residual residual = measure_residual(patch, motions, context);
    EXPECT_NEAR(residual.max, region.residual.max, 1e-9);
    EXPECT_NEAR(residual.rms, region.residual.rms, 1e-9);
    ++measured;
  }
  EXPECT_GE(measured, 2);
}

// Of a surface whose triangles no motion takes to one another, at the same tolerance in lengths: a turned box has
// another diagonal.
TEST(DetectSuite, TheSameIsFoundInAnyPose) {
  RunContext context;
  const Mesh mesh = remesh(suite_model("stool_C3v").mesh, {}, context).mesh;
  const SymmetryAnnotation expected = detect(mesh, {}, context);
  ASSERT_GE(expected.regions.size(), 3U);
  const Motion motion{axis_rotation(Eigen::Vector3d(3, -1, 2).normalized(), 2), {1, 2, -3}};
  Mesh moved = mesh;
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
    moved.vertices.row(v) = motion(mesh.vertices.row(v).transpose()).transpose();
  }
  DetectOptions options;
  options.tolerance *= diagonal(mesh.vertices) / diagonal(moved.vertices);
  const SymmetryAnnotation found = detect(moved, options, context);
  ASSERT_EQ(found.regions.size(), expected.regions.size());
  ASSERT_EQ(found.patterns.size(), expected.patterns.size());
  for (std::size_t r = 0; r < found.regions.size(); ++r) {
    EXPECT_EQ(found.regions[r].group, expected.regions[r].group);
    EXPECT_EQ(found.regions[r].faces, expected.regions[r].faces);
    EXPECT_LT((found.regions[r].centre - motion(expected.regions[r].centre)).norm(), 1e-6 * diagonal(mesh.vertices));
  }
}

// What a turned shape has left to turn about once a piece is off it, whichever way it is cut.
class CutVase : public testing::TestWithParam<int> {};

TEST_P(CutVase, KeepsItsAxis) {
  const TruthModel model = suite_model("vase");
  Mesh mesh = model.mesh;
  const double size = diagonal(mesh.vertices);
  const double turn = GetParam() * std::numbers::pi / 5;
  const Eigen::Vector3d outwards(std::cos(turn), std::sin(turn), 0.4);
  const Eigen::Vector3d centre = bounding_box_centre(mesh.vertices);
  const HalfSpace removed{centre + 0.12 * size * outwards.normalized(), outwards};
  mesh = cut(subdivided(mesh, 0.02 * size).mesh, removed).mesh;
  RunContext context;
  const SymmetryAnnotation found = detect(mesh, {}, context);
  ASSERT_EQ(count_of(found, "Cinfv"), 1);
  const Region& turned =
      *std::ranges::find_if(found.regions, [](const Region& region) { return region.group.continuous(); });
  EXPECT_LT(turned.axis.cross(model.truth.expected.regions.at(0).axis).norm(), 0.005);
  EXPECT_LE(turned.residual.max, found.tolerance);
  EXPECT_GT(turned.faces.size(), static_cast<std::size_t>(0.4 * static_cast<double>(mesh.faces.rows())));
}

INSTANTIATE_TEST_SUITE_P(Directions, CutVase, testing::Range(0, 5));

}  // namespace
}  // namespace orbifit

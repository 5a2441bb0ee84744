#include "support/own_group.h"

#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "base/random.h"
#include "resolution/denoise.h"
#include "shapes.h"

namespace orbifit {
namespace {

std::string symbol_of(const Mesh& mesh, double tolerance = 0.005, std::optional<double> largest_blot = {}) {
  const PreparedMesh prepared = prepare(mesh);
  const RunContext context;
  SurfacePatch patch = make_patch(prepared, test::all_faces(mesh), 2500, tolerance, context, "test");
  if (largest_blot) patch.largest_blot = *largest_blot;
  const DirectionSet screen = hemisphere_directions(2000);
  const std::optional<OwnGroup> group = find_own_group(patch, &screen, {}, context);
  return group ? group->placement.group.symbol() : "C1";
}

class Prisms : public testing::TestWithParam<int> {};

TEST_P(Prisms, HaveTheirSides) {
  const int n = GetParam();
  EXPECT_EQ(symbol_of(test::prism(n, 1, 1.4)), "D" + std::to_string(n) + "h");
}

INSTANTIATE_TEST_SUITE_P(Sides, Prisms, testing::Values(3, 5, 6, 7, 9, 12));

TEST(OwnGroup, ManyFacetsAreACylinder) {
  EXPECT_EQ(symbol_of(test::prism(64, 1, 1.4)), "Dinfh");
  EXPECT_EQ(symbol_of(test::prism(64, 1, 0.2)), "Dinfh");
}

TEST(OwnGroup, TheToleranceDecidesWhatIsRound) {
  EXPECT_EQ(symbol_of(test::prism(24, 1, 1), 0.01), "Dinfh");
  EXPECT_EQ(symbol_of(test::prism(24, 1, 1), 0.0005), "D24h");
}

TEST(OwnGroup, IsTheExactOneWhereOthersHoldToTheTolerance) {
  // By ninths and elevenths of a turn as well.
  EXPECT_EQ(symbol_of(test::prism(6, 1, 2), 0.035), "D6h");
  EXPECT_EQ(symbol_of(test::prism(7, 1, 2), 0.032), "D7h");
  EXPECT_EQ(symbol_of(test::prism(7, 1, 2), 0.036), "Dinfh") << "round to the tolerance";
  EXPECT_EQ(symbol_of(test::prism(7, 1, 4), 0.0225), "D7h");
}

TEST(OwnGroup, ATreadIsNoFacet) {
  // A drum of 120 sides, round to the tolerance, of which every fourth to sixth corner lies a little lower.
  constexpr int kSides = 120;
  Mesh drum = test::prism(kSides, 1, 1.4);
  for (int i = 0; i < kSides; ++i) {
    if (i % 12 < 4 || i % 12 > 6) continue;
    drum.vertices.row(i).head<2>() *= 0.992;
    drum.vertices.row(kSides + i).head<2>() *= 0.992;
  }
  EXPECT_EQ(symbol_of(drum), "D10h");
}

// Flat sides that are off a circle by a few times what noise leaves of them; facets of a finer drum are not.
TEST(OwnGroup, SidesAreToldFromNoise) {
  constexpr double kNoise = 0.004;
  const auto symbol_with_noise = [](int sides) {
    Mesh mesh = test::subdivided(test::prism(sides, 1, 1.4), sides == 8 ? 3 : 1);
    Random random(4);
    PreparedMesh prepared = prepare(mesh);
    Points steps(static_cast<Eigen::Index>(prepared.faces_of_vertex.size()), 3);  // vertices at one place stay together
    for (double& step : steps.reshaped()) step = kNoise * diagonal(mesh.vertices) * random.normal();
    mesh.vertices += steps(prepared.weld.group_of_vertex, Eigen::all);
    prepared = prepare(mesh);
    prepared.noise = kNoise;
    denoise(prepared, kNoise, {});
    const RunContext context;
    const SurfacePatch patch = make_patch(prepared, test::all_faces(mesh), 2500, 0.025, context, "test");
    const DirectionSet screen = hemisphere_directions(2000);
    const std::optional<OwnGroup> group = find_own_group(patch, &screen, {}, context);
    return group ? group->placement.group.symbol() : "C1";
  };
  EXPECT_EQ(symbol_with_noise(8), "D8h");
  EXPECT_EQ(symbol_with_noise(32), "Dinfh");
}

TEST(OwnGroup, NearMissesAreTold) {
  EXPECT_EQ(symbol_of(test::box(1, 1.006, 2), 0.0008), "D2h");
  EXPECT_EQ(symbol_of(test::box(1, 1.006, 2), 0.005), "D4h");
  EXPECT_EQ(symbol_of(test::box(1, 1, 1)), "Oh");
  EXPECT_EQ(symbol_of(test::box(1, 1.05, 1.1)), "D2h");
}

TEST(OwnGroup, AHoleCountsUnlessItIsForgiven) {
  // A square bar with a hole of about a hundredth of its area in one end.
  const Mesh bar = test::subdivided(test::box(1, 1, 2), 4);
  Mesh holed = bar;
  Eigen::Index count = 0;
  for (Eigen::Index f = 0; f < bar.faces.rows(); ++f) {
    Eigen::RowVector3d centroid = Eigen::RowVector3d::Zero();
    for (const int vertex : bar.faces.row(f)) centroid += bar.vertices.row(vertex) / 3;
    const bool hole = centroid.z() > 0.99 && centroid.head<2>().cwiseAbs().maxCoeff() < 0.16;
    if (!hole) holed.faces.row(count++) = bar.faces.row(f);
  }
  ASSERT_LT(count, bar.faces.rows());
  holed.faces.conservativeResize(count, 3);
  EXPECT_EQ(symbol_of(bar), "D4h");
  EXPECT_EQ(symbol_of(holed), "C4v");
  EXPECT_EQ(symbol_of(holed, 0.005, 0.02), "D4h");
}

TEST(OwnGroup, NoneWhereThereIsNone) {
  EXPECT_EQ(symbol_of(test::scalene()), "C1");
}

}  // namespace
}  // namespace orbifit

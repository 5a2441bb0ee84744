#include "orbifit/detection/own_group.h"

#include <gtest/gtest.h>

#include "shapes.h"

namespace orbifit {
namespace {

std::string symbol_of(const Mesh& mesh, double tolerance = 0.005) {
  const PreparedMesh prepared = prepare(mesh);
  const RunContext context;
  const SurfacePatch patch = make_patch(prepared, test::all_faces(mesh), 2500, tolerance, context, "test");
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

TEST(OwnGroup, NearMissesAreTold) {
  EXPECT_EQ(symbol_of(test::box(1, 1.006, 2), 0.0008), "D2h");
  EXPECT_EQ(symbol_of(test::box(1, 1.006, 2), 0.005), "D4h");
  EXPECT_EQ(symbol_of(test::box(1, 1, 1)), "Oh");
  EXPECT_EQ(symbol_of(test::box(1, 1.05, 1.1)), "D2h");
}

TEST(OwnGroup, NoneWhereThereIsNone) {
  EXPECT_EQ(symbol_of(test::scalene()), "C1");
}

}  // namespace
}  // namespace orbifit

#include "group/patterns.h"

#include <algorithm>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "group/verification.h"
#include "patterns/pattern_search.h"
#include "shapes.h"

namespace orbifit {
namespace {

using Eigen::Vector3d;

Arrangement named(const std::vector<Motion>& motions, const GroupPlacement* own = nullptr) {
  return arrange(motions, own, {0.1, 0.2, 0}, 0.1, 0.002);
}

TEST(Arrange, RowsGridsAndBlocks) {
  std::vector<Motion> row, grid, block;
  for (int i = 0; i < 5; ++i) row.push_back(test::shift(0.3 * i, 0.1 * i, 0));
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 4; ++j) grid.push_back(test::shift(0.3 * i, 0.05 * i + 0.2 * j, 0));
  }
  for (int i = 0; i < 8; ++i) block.push_back(test::shift((i & 1) * 0.3, (i & 2) * 0.2, (i & 4) * 0.1));
  EXPECT_EQ(named(row).kind, Pattern::Kind::translation_1d);
  EXPECT_EQ(named(grid).kind, Pattern::Kind::translation_2d);
  EXPECT_EQ(named(block).kind, Pattern::Kind::translation_3d);
  EXPECT_LT((named(row).generators[0].translation.cwiseAbs() - Vector3d(0.3, 0.1, 0)).norm(), 1e-12);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    EXPECT_LT((named(grid).motions[i].translation - grid[i].translation).norm(), 1e-12);
  }
}

TEST(Arrange, TwoCopiesOrScatteredOnesAreNoLattice) {
  EXPECT_EQ(named({Motion{}, test::shift(0.3, 0, 0)}).kind, Pattern::Kind::congruent);
  EXPECT_EQ(named({Motion{}, test::shift(0.3, 0, 0), test::shift(0.71, 0, 0)}).kind, Pattern::Kind::congruent);
}

TEST(Arrange, AGapLeavesARowARow) {
  EXPECT_EQ(named({Motion{}, test::shift(0.2, 0, 0), test::shift(0.6, 0, 0)}).kind, Pattern::Kind::translation_1d);
}

TEST(Arrange, AnArcOfRotations) {
  std::vector<Motion> arc;
  for (int i = 0; i < 4; ++i) arc.push_back(Motion::rotation({0, 0, 1}, 0.4 * i, {1, 0, 0}));
  const Arrangement found = named(arc);
  ASSERT_EQ(found.kind, Pattern::Kind::rotation);
  EXPECT_LT(motion_distance(found.generators[0], arc[1], {0, 0, 0}, 1), 1e-9);
}

TEST(Arrange, AnArcOfCopiesThatMayLieEitherWay) {
  // Beyond a quarter turn the copies' own half-turn gives motions that turn less than the arc's.
  const GroupPlacement own{*PointGroup::parse("D2h"), GroupFrame::Identity(), Vector3d(0.1, 0.2, 0)};
  std::vector<Motion> arc;
  for (int i = 0; i < 8; ++i) {
    const Motion place = Motion::rotation({0, 0, 1}, 0.3 * i, {1, 0, 0});
    arc.push_back(i % 3 == 1 ? place * Motion::rotation({0, 0, 1}, std::numbers::pi, own.centre) : place);
  }
  const Arrangement found = named(arc, &own);
  ASSERT_EQ(found.kind, Pattern::Kind::rotation);
  EXPECT_NEAR(axis_angle(found.generators[0].linear).angle, 0.3, 1e-9);
}

TEST(Arrange, AScrew) {
  const auto place = [](int i) {
    return test::shift(0, 0, 0.07 * i) * Motion::rotation({0, 0, 1}, 0.5 * i, {1, 0, 0});
  };
  std::vector<Motion> stair;
  for (int i = 0; i < 15; ++i) stair.push_back(place(i));
  const Arrangement found = named(stair);
  ASSERT_EQ(found.kind, Pattern::Kind::screw);
  EXPECT_LT(motion_distance(found.generators[0], place(1), {0, 0, 0}, 1), 1e-9);
  // Three steps out of fifteen are no stair.
  EXPECT_EQ(named({place(0), place(6), place(13)}).kind, Pattern::Kind::congruent);
}

TEST(Arrange, ARowOfPlacesThatAreALittleOff) {
  // No step between two of them leads to all others.
  std::vector<Motion> row;
  for (int i = 0; i < 8; ++i) row.push_back(test::shift(0.1 * i, 0.0009 * (i % 3 - 1), 0.0006 * (i % 2)));
  row[0] = Motion{};
  const Arrangement found = named(row);
  ASSERT_EQ(found.kind, Pattern::Kind::translation_1d);
  EXPECT_NEAR(found.generators[0].translation.norm(), 0.1, 3e-4);
  EXPECT_EQ(found.filled, 1);
}

TEST(Arrange, TheOwnGroupStraightensACopy) {
  const GroupPlacement own{*PointGroup::parse("D4h"), GroupFrame::Identity(), Vector3d(0.1, 0.2, 0)};
  std::vector<Motion> motions{Motion{}};
  for (int i = 1; i < 4; ++i) {
    motions.push_back(test::shift(0.3 * i, 0, 0) * Motion::rotation({0, 0, 1}, i * std::numbers::pi / 2, own.centre));
  }
  EXPECT_EQ(named(motions, &own).kind, Pattern::Kind::translation_1d);
  const GroupPlacement round{*PointGroup::parse("Cinfv"), GroupFrame::Identity(), Vector3d(0.1, 0.2, 0)};
  for (int i = 1; i < 4; ++i) {
    motions[static_cast<std::size_t>(i)] =
        test::shift(0.3 * i, 0, 0) * Motion::rotation({0, 0, 1}, 0.7 * i, round.centre);
  }
  EXPECT_EQ(named(motions, &round).kind, Pattern::Kind::translation_1d);
  EXPECT_NE(named(motions).kind, Pattern::Kind::translation_1d);
}

TEST(Arrange, AScrewOfWhichPlacesAreEmpty) {
  // No copy is one step from another that comes first: the step is half of the smallest motion, along the axis as well.
  const Motion step = test::shift(0, 0, 0.07) * Motion::rotation({0, 0, 1}, 0.5, {1, 0, 0});
  const Motion twice = step * step;
  const Arrangement found = named({Motion{}, twice, twice * step, twice * twice * step});
  ASSERT_EQ(found.kind, Pattern::Kind::screw);
  EXPECT_LT(motion_distance(found.generators[0], step, {0, 0, 0}, 1), 1e-9);
}

TEST(Arrange, CopiesAlongAnArcThatAreTurnedAnyHowAreNone) {
  const Vector3d centroid(0.1, 0.2, 0);
  std::vector<Motion> copies;
  for (int i = 0; i < 5; ++i) {
    copies.push_back(Motion::rotation({0, 0, 1}, 0.4 * i, {1, 0, 0}) *
                     Motion::rotation(Vector3d(1, 2, 3).normalized(), 1.1 * i * (i - 1), centroid));
  }
  EXPECT_EQ(named(copies).kind, Pattern::Kind::congruent);
}

struct Straightening {
  const char* family;
  bool vertical, horizontal, half_turn;  // whether the group has mirrors through its axis, across it, half-turns

  friend void PrintTo(const Straightening& of, std::ostream* out) { *out << of.family; }
};

class Straightened : public testing::TestWithParam<Straightening> {};

TEST_P(Straightened, TakesAwayWhatTheOwnGroupHas) {
  const auto& [family, vertical, horizontal, half_turn] = GetParam();
  const GroupPlacement own{*PointGroup::parse(family), GroupFrame::Identity(), Vector3d(0.1, 0.2, 0)};
  const auto about = [&](double x, double y, double z) {
    return Motion::about(Vector3d(x, y, z).asDiagonal().toDenseMatrix(), own.centre);
  };
  const std::vector<std::pair<Motion, bool>> elements{
      {Motion{}, true}, {about(1, -1, 1), vertical}, {about(1, 1, -1), horizontal}, {about(1, -1, -1), half_turn}};
  for (const auto& [element, has] : elements) {
    const Motion copy = test::shift(0.3, 0.4, 0.5) * element * Motion::rotation({0, 0, 1}, 0.7, own.centre);
    const double left = (straightened(copy, own).linear - Eigen::Matrix3d::Identity()).norm();
    EXPECT_EQ(left < 1e-9, has) << element.linear;
  }
}

INSTANTIATE_TEST_SUITE_P(Families, Straightened,
                         testing::Values(Straightening{"Cinf", false, false, false},
                                         Straightening{"Cinfv", true, false, false},
                                         Straightening{"Cinfh", false, true, false},
                                         Straightening{"Dinf", false, false, true},
                                         Straightening{"Dinfh", true, true, true}),
                         [](const auto& of) { return std::string(of.param.family); });

// Places along an arc, of which some hold blocks that are off by a third of a step.
struct Misplaced {
  int count;
  std::vector<int> off;
  std::size_t found;  // blocks in order, none where that is 0

  friend void PrintTo(const Misplaced& of, std::ostream* out) { *out << of.off.size() << " of " << of.count; }
};

class Arc : public testing::TestWithParam<Misplaced> {};

TEST_P(Arc, IsFoundButForOneOutOfPlace) {
  const auto& [count, off, expected] = GetParam();
  std::vector<Mesh> blocks;
  for (int i = 0; i < count; ++i) {
    const double place = std::ranges::find(off, i) == off.end() ? i : i + 0.35;
    const Motion turn = Motion::rotation(Vector3d::UnitZ(), 0.37 * place, Vector3d::Zero());
    blocks.push_back(test::moved(test::moved(test::box(0.5, 0.3, 0.4), test::shift(3, 0, 0)), turn));
  }
  const PreparedMesh prepared = prepare(test::joined(blocks));
  const RunContext context;
  const PartRegionOptions options;
  const PartRegions parts =
      find_part_regions(prepared, survey_components(prepared, options.tolerance, options.least_share, context),
                        SurfaceIndex(prepared.mesh), {}, hemisphere_directions(500), options, context);
  const std::vector<Pattern> found = find_patterns(prepared, parts, {}, options, context);
  const auto arc = std::ranges::find(found, Pattern::Kind::rotation, &Pattern::kind);
  ASSERT_EQ(arc != found.end(), expected > 0);
  if (expected == 0) return;
  EXPECT_EQ(arc->instances.size(), expected);
  EXPECT_NEAR(axis_angle(arc->generators.at(0).linear).angle, 0.37, 1e-9);
  EXPECT_LT(arc->residual.max, 1e-9);
  for (const PatternInstance& instance : arc->instances) {
    const int block = instance.faces.front() / 12;
    EXPECT_EQ(std::ranges::find(off, block), off.end()) << block;
  }
}

INSTANTIATE_TEST_SUITE_P(Blocks, Arc,
                         testing::Values(Misplaced{8, {}, 8}, Misplaced{8, {3}, 7}, Misplaced{8, {0}, 7},
                                         Misplaced{8, {7}, 7}, Misplaced{8, {2, 5}, 0}, Misplaced{5, {2}, 0}),
                         [](const auto& of) { return "Arc" + std::to_string(of.index); });

}  // namespace
}  // namespace orbifit

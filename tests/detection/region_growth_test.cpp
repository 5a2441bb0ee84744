#include "support/region_growth.h"

#include <numbers>
#include <ostream>
#include <string>

#include <gtest/gtest.h>

#include "shapes.h"

namespace orbifit {
namespace {

GroupPlacement placed(const char* symbol, const Eigen::Vector3d& axis = Eigen::Vector3d::UnitZ(),
                      const Eigen::Vector3d& centre = Eigen::Vector3d::Zero()) {
  return {*PointGroup::parse(symbol), frame_about(axis), centre};
}

TEST(ContainsGroup, FollowsTheSubgroups) {
  const auto holds = [](const GroupPlacement& outer, const GroupPlacement& inner) {
    return contains_group(outer, inner, Eigen::Vector3d::Zero(), 1, 0.005);
  };
  EXPECT_TRUE(holds(placed("C4v"), placed("C2")));
  EXPECT_TRUE(holds(placed("D4h"), placed("C4v")));
  EXPECT_FALSE(holds(placed("C4v"), placed("D4h")));
  EXPECT_FALSE(holds(placed("C6"), placed("C4")));
  EXPECT_TRUE(holds(placed("Oh"), placed("D4h")));
  EXPECT_FALSE(holds(placed("Oh"), placed("D6h")));
  EXPECT_TRUE(holds(placed("Dinfh"), placed("D7h")));
  EXPECT_TRUE(holds(placed("Cinfv"), placed("Cs", Eigen::Vector3d::UnitX())));
  EXPECT_FALSE(holds(placed("Cinfv"), placed("Cs", Eigen::Vector3d::UnitZ())));
  EXPECT_TRUE(holds(placed("Kh"), placed("Ih")));
  EXPECT_FALSE(holds(placed("D100h"), placed("Dinfh")));
  EXPECT_TRUE(holds(placed("Cinfv"), placed("C5", Eigen::Vector3d::UnitZ(), {0, 0, 3})));
  EXPECT_FALSE(holds(placed("Cinfv"), placed("C5", Eigen::Vector3d::UnitZ(), {0.1, 0, 0})));
  EXPECT_FALSE(holds(placed("Dinfh"), placed("Ci", Eigen::Vector3d::UnitZ(), {0, 0, 0.1})));
}

TEST(ComponentMover, TakesWhatTheGroupMovesOntoItselfAndNothingElse) {
  std::vector<Mesh> parts{test::prism(40, 1, 0.3)};
  for (int i = 0; i < 5; ++i) {
    const Mesh bolt = test::moved(test::box(0.1, 0.14, 0.2), test::shift(0.7, 0, 0.25));
    parts.push_back(test::moved(bolt, Motion::rotation({0, 0, 1}, 2 * std::numbers::pi * i / 5, {0, 0, 0})));
  }
  parts.push_back(test::moved(test::box(0.3, 0.2, 0.1), test::shift(0.1, 0.2, 0.6)));
  const PreparedMesh prepared = prepare(test::joined(parts));
  const RunContext context;
  const ComponentSurvey survey = survey_components(prepared, 0.005, 0, context);
  const SurfaceIndex whole(prepared.mesh);
  const Eigen::Vector3d centre = -prepared.input_of_normalised.translation / prepared.input_of_normalised.scale;
  ComponentMover mover(prepared, survey, whole, 0.005, context);
  const GroupPlacement five{*PointGroup::parse("C5"), GroupFrame::Identity(), centre};
  EXPECT_EQ(mover.permuted(five, {1, 2, 3, 4, 5}), (std::vector<int>{0, 1, 2, 3, 4, 5}));
  const GroupPlacement three{*PointGroup::parse("C3"), GroupFrame::Identity(), centre};
  EXPECT_EQ(mover.permuted(three, {0}), (std::vector<int>{0}));
}

// A ring of n blocks on a plate, one of them turned about itself by a quarter.
struct RingOfParts {
  const char* block;
  int count;
  int turned;  // -1: none

  friend void PrintTo(const RingOfParts& ring, std::ostream* stream) { *stream << ring.block << ring.count; }
};

class KnownRing : public testing::TestWithParam<RingOfParts> {};

TEST_P(KnownRing, IsPermutedAsWhenMeasured) {
  const auto& [block, count, turned] = GetParam();
  const std::string name = block;
  const Mesh shape = name == "brick"   ? test::box(0.1, 0.14, 0.2)
                     : name == "cube"  ? test::box(0.15, 0.15, 0.15)
                     : name == "wedge" ? test::prism(3, 0.1, 0.2)
                                       : test::prism(24, 0.1, 0.2);
  const std::string own = name == "brick" ? "D2h" : name == "cube" ? "Oh" : name == "wedge" ? "D3h" : "Dinfh";
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  std::vector<Mesh> parts{test::box(2, 2, 0.1)};
  for (int i = 0; i < count; ++i) {
    Mesh part = shape;
    if (i == turned) part = test::moved(part, Motion::rotation(up, std::numbers::pi / 2, Eigen::Vector3d::Zero()));
    part = test::moved(part, test::shift(0.7, 0, 0.3));
    parts.push_back(test::moved(part, Motion::rotation(up, 2 * std::numbers::pi * i / count, Eigen::Vector3d::Zero())));
  }
  const PreparedMesh prepared = prepare(test::joined(parts));
  const RunContext context;
  const ComponentSurvey survey = survey_components(prepared, 0.005, 0, context);
  const SurfaceIndex whole(prepared.mesh);
  ComponentMover measured(prepared, survey, whole, 0.005, context);
  ComponentMover told(prepared, survey, whole, 0.005, context);
  int classes = 0;
  for (std::size_t k = 0; k < survey.classes.size(); ++k) {
    const CongruenceClass& kind = survey.classes[k];
    if (kind.members.size() < 2) continue;
    ++classes;
    // The block's frame: the class's first member stands somewhere on the ring.
    const SurfaceMoments& moments = survey.moments[static_cast<std::size_t>(kind.members.front())];
    const Eigen::Vector3d out = (moments.centroid - up * up.dot(moments.centroid)).normalized();
    told.know(k, {*PointGroup::parse(own), frame_about(up, out), moments.centroid});
  }
  ASSERT_EQ(classes, 1);
  const Eigen::Vector3d centre = survey.moments[0].centroid;
  for (const char* symbol : {"C2", "C3", "C4", "C5", "C6", "C2v", "C4v", "C6v", "Cs", "Ci", "Cinf"}) {
    const GroupPlacement placement{*PointGroup::parse(symbol), GroupFrame::Identity(), centre};
    EXPECT_EQ(told.permuted(placement, {}), measured.permuted(placement, {})) << symbol;
  }
}

INSTANTIATE_TEST_SUITE_P(Blocks, KnownRing,
                         testing::Values(RingOfParts{"brick", 4, -1}, RingOfParts{"brick", 6, 2},
                                         RingOfParts{"cube", 4, 1}, RingOfParts{"cube", 5, -1},
                                         RingOfParts{"wedge", 3, 1}, RingOfParts{"wedge", 6, -1},
                                         RingOfParts{"peg", 5, 0}, RingOfParts{"peg", 8, -1}),
                         [](const auto& each) { return testing::PrintToString(each.param); });

TEST(ComponentMover, ASubgroupTakesMoreParts) {
  // A square plate with D4h; two blocks on it, which only half a turn and two mirrors carry onto one another.
  const Mesh plate = test::box(2, 2, 0.1);
  const Mesh block = test::box(0.3, 0.2, 0.4);
  const PreparedMesh prepared = prepare(test::joined(
      {plate, test::moved(block, test::shift(0.6, 0, 0.3)), test::moved(block, test::shift(-0.6, 0, 0.3))}));
  const RunContext context;
  const ComponentSurvey survey = survey_components(prepared, 0.005, 0, context);
  const SurfaceIndex whole(prepared.mesh);
  ComponentMover mover(prepared, survey, whole, 0.005, context);
  const GroupPlacement placement{*PointGroup::parse("D4h"), GroupFrame::Identity(), survey.moments[0].centroid};
  const std::vector<SubgroupRegion> regions = mover.subgroup_regions(placement, {0});
  ASSERT_FALSE(regions.empty());
  EXPECT_EQ(regions.front().placement.group.symbol(), "C2v");
  EXPECT_EQ(regions.front().components, (std::vector<int>{0, 1, 2}));
}

}  // namespace
}  // namespace orbifit

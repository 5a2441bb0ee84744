#include "orbifit/detection/region_growth.h"

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

#include "group/axis_orders.h"

#include <numbers>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "shapes.h"

namespace orbifit {
namespace {

TEST(RotationOrders, DoNotTakeSmallTurnsForSymmetries) {
  const Mesh mesh = test::prism(6, 1, 2);
  const PreparedMesh prepared = prepare(mesh);
  const RunContext context;
  const SurfacePatch patch = make_patch(prepared, test::all_faces(mesh), 1000, 0.005, context, "test");
  EXPECT_EQ(rotation_orders(patch, Eigen::Vector3d::UnitZ(), patch.moments.centroid, 1), (std::vector<int>{6, 3, 2}));
}

TEST(RankOrders, PutThePerfectBeforeTheHigh) {
  // Twelve shallow flutes: at this tolerance 24 fits nearly as well, 12 exactly.
  const Mesh mesh = test::prism(12, 1, 2);
  const PreparedMesh prepared = prepare(mesh);
  const RunContext context;
  const SurfacePatch patch = make_patch(prepared, test::all_faces(mesh), 1000, 0.005, context, "test");
  const std::vector<RankedOrder> ranked =
      rank_orders(patch, {36, 24, 12, 7, 5, 4}, Eigen::Vector3d::UnitZ(), patch.moments.centroid);
  ASSERT_FALSE(ranked.empty());
  EXPECT_EQ(ranked.front().order, 12);
  EXPECT_GE(ranked.front().share, 0.999);
}

TEST(RankOrders, EveryMultipleCounts) {
  // Ten of twelve blocks: a twelfth of a turn brings one of them to an empty place, half a turn two.
  std::vector<Mesh> blocks;
  for (int i = 0; i < 10; ++i) {
    const Motion turn = Motion::rotation(Eigen::Vector3d::UnitZ(), std::numbers::pi / 6 * i, Eigen::Vector3d::Zero());
    blocks.push_back(test::moved(test::moved(test::box(0.5, 0.3, 0.4), test::shift(3, 0, 0)), turn));
  }
  const Mesh mesh = test::joined(blocks);
  const PreparedMesh prepared = prepare(mesh);
  const RunContext context;
  const SurfacePatch patch = make_patch(prepared, test::all_faces(mesh), 1000, 0.005, context, "test");
  const Eigen::Vector3d centre = inverse(prepared.input_of_normalised)(Eigen::Vector3d::Zero());
  EXPECT_TRUE(rank_orders(patch, {12}, Eigen::Vector3d::UnitZ(), centre).empty());
}

TEST(ContinuousTolerance, IsTighterForSmallParts) {
  const Mesh small = test::box(0.1, 0.1, 0.1);
  const PreparedMesh prepared = prepare(test::joined({test::box(1, 1, 1), small}));
  const RunContext context;
  for (const auto& [faces, diagonals] :
       {std::pair{std::vector<int>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}, 1.0},
        std::pair{std::vector<int>{12, 13, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23}, 0.25}}) {
    const SurfacePatch patch = make_patch(prepared, faces, 100, 0.005, context, "test");
    EXPECT_NEAR(continuous_tolerance(patch), diagonals * 0.005, 1e-12);
  }
}

TEST(ContinuousAbout, TakesFacetsBelowTheTolerance) {
  const RunContext context;
  for (const auto& [sides, round] : {std::pair{8, false}, std::pair{64, true}}) {
    const Mesh mesh = test::prism(sides, 1, 2);
    const PreparedMesh prepared = prepare(mesh);
    const SurfacePatch patch = make_patch(prepared, test::all_faces(mesh), 1000, 0.005, context, "test");
    EXPECT_EQ(continuous_about(patch, Eigen::Vector3d::UnitZ(), patch.moments.centroid), round) << sides;
    EXPECT_FALSE(continuous_about(patch, Eigen::Vector3d::UnitX(), patch.moments.centroid)) << sides;
  }
}

}  // namespace
}  // namespace orbifit

#include "group/axis_orders.h"

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

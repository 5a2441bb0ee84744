#include "group/candidates.h"

#include <gtest/gtest.h>

#include "base/random.h"
#include "shapes.h"

namespace orbifit {
namespace {

using Eigen::Vector3d;

TEST(DistanceGrid, IsAsFarOffAsACell) {
  Random random(3);
  Points points(60, 3);
  for (int i = 0; i < 60; ++i) points.row(i) = 0.9 * random.direction();
  const DistanceGrid grid(points, Vector3d::Zero(), 1, 40);
  for (int i = 0; i < 500; ++i) {
    const Vector3d query = random.uniform() * random.direction();
    const double exact = (points.rowwise() - query.transpose()).rowwise().norm().minCoeff();
    EXPECT_NEAR(grid(query), exact, 1.8 * grid.cell());
  }
}

TEST(HemisphereDirections, LeaveNoGap) {
  const DirectionSet set = hemisphere_directions(1000);
  Random random(4);
  for (int i = 0; i < 300; ++i) {
    const Vector3d wanted = random.direction();
    double best = 0;
    for (const Vector3d& d : set.directions) best = std::max(best, std::abs(d.dot(wanted)));
    EXPECT_LT(std::acos(std::min(1.0, best)), 1.2 * set.spacing);
  }
}

TEST(FindCandidates, SeesTheMirrorsOfABoxInAnyPose) {
  Random random(5);
  const Eigen::Matrix3d turn = random.rotation();
  const Mesh mesh = test::moved(test::box(1, 1.3, 2), {turn, Vector3d::Zero()});
  const PreparedMesh prepared = prepare(mesh);
  const RunContext context;
  const SurfacePatch patch = make_patch(prepared, test::all_faces(mesh), 1000, 0.005, context, "test");
  const DirectionSet set = hemisphere_directions(2500);
  const CandidateDirections found = find_candidates(patch, &set, context);
  for (int k = 0; k < 3; ++k) {
    const auto nearest = [&](const std::vector<Vector3d>& list) {
      double best = 0;
      for (const Vector3d& d : list) best = std::max(best, std::abs(d.dot(turn.col(k))));
      return std::acos(std::min(1.0, best));
    };
    EXPECT_LT(nearest(found.principal), 1e-6);
    EXPECT_LT(nearest(found.mirrors), 0.06);
    EXPECT_LT(nearest(found.twofold), 0.06);
  }
}

TEST(FindCandidates, FacesThatRepeatOthersSayNothing) {
  Mesh mesh = test::box(1, 1.3, 2);
  const Triangles once = mesh.faces;
  mesh.faces.conservativeResize(2 * once.rows(), 3);
  mesh.faces.bottomRows(once.rows()) = once;
  const PreparedMesh prepared = prepare(mesh);
  const RunContext context;
  const SurfacePatch patch = make_patch(prepared, test::all_faces(mesh), 1000, 0.005, context, "test");
  const DirectionSet set = hemisphere_directions(500);
  const CandidateDirections found = find_candidates(patch, &set, context);
  EXPECT_TRUE(std::ranges::any_of(found.mirrors, [&](const Vector3d& d) { return std::abs(d.z()) > 0.99; }));
}

TEST(FindCandidates, SeesTheThreefoldAxesOfACubeFirst) {
  const Mesh mesh = test::box(1, 1, 1);
  const PreparedMesh prepared = prepare(mesh);
  const RunContext context;
  const SurfacePatch patch = make_patch(prepared, test::all_faces(mesh), 1000, 0.005, context, "test");
  const DirectionSet set = hemisphere_directions(kScreenDirections);
  const CandidateDirections found = find_candidates(patch, &set, context);
  ASSERT_FALSE(found.threefold.empty());
  EXPECT_LT(std::acos(found.threefold.front().cwiseAbs().dot(Vector3d::Ones().normalized())), 0.06);
}

TEST(FindCandidates, FarthestVerticesGiveTheAxesOfACube) {
  const Mesh mesh = test::box(1, 1, 1);
  const PreparedMesh prepared = prepare(mesh);
  const RunContext context;
  const SurfacePatch patch = make_patch(prepared, test::all_faces(mesh), 1000, 0.005, context, "test");
  const DirectionSet set = hemisphere_directions(500);
  const CandidateDirections found = find_candidates(patch, &set, context);
  const auto has = [](const std::vector<Vector3d>& list, const Vector3d& wanted) {
    return std::ranges::any_of(list, [&](const Vector3d& d) { return d.cross(wanted.normalized()).norm() < 1e-9; });
  };
  EXPECT_TRUE(has(found.corner_axes, {1, 1, 1}) || has(found.corner_axes, {-1, -1, 1}));
  EXPECT_TRUE(has(found.corner_axes, {0, 0, 1}));
  EXPECT_TRUE(has(found.corner_mirrors, {0, 0, 1}));
}

}  // namespace
}  // namespace orbifit

#include "support/trimmed_regions.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include <gtest/gtest.h>

#include "group/verification.h"
#include "shapes.h"

namespace orbifit {
namespace {

using Eigen::Vector3d;

constexpr int kCells = 80;           // along each side of a sheet
constexpr double kTolerance = 0.01;  // of the diagonal: more than an edge

constexpr double kBump = 0.025;  // radius
const Eigen::Vector2d kBumpAt(0.2, 0.15);

// Flat, of side 1, but for a bump.
Mesh bumpy() {
  return test::sheet(kCells,
                     [](double x, double y) { return (Eigen::Vector2d(x, y) - kBumpAt).norm() < kBump ? 0.05 : 0.0; });
}

FoundRegion region_of(const PreparedMesh& prepared, const char* symbol, std::vector<int> faces) {
  FoundRegion region;
  region.placement = {*PointGroup::parse(symbol), GroupFrame::Identity(), Vector3d::Zero()};
  region.faces = std::move(faces);
  region.area = area_of(prepared, region.faces);
  return region;
}

class TrimmedRegions : public testing::TestWithParam<const char*> {};

TEST_P(TrimmedRegions, LoseWhatHasNoImageAndNoMore) {
  // The sheet has every such group but for one bump, which lies on none of their axes and planes.
  const Mesh mesh = bumpy();
  PreparedMesh prepared = prepare(mesh);
  const Vector3d centre = inverse(prepared.input_of_normalised)(Vector3d::Zero());
  std::vector<FoundRegion> regions{region_of(prepared, GetParam(), test::all_faces(mesh))};
  regions[0].placement.centre = centre;
  const std::vector<Motion> motions =
      judged_motions(regions[0].placement.group, regions[0].placement.frame, regions[0].placement.centre);
  trim_regions(prepared, kTolerance, BorderMoves::both_ways, RunContext{}, regions);
  const std::vector<int>& left = regions[0].faces;
  ASSERT_LT(left.size(), static_cast<std::size_t>(mesh.faces.rows()));
  EXPECT_FALSE(regions[0].residual);
  EXPECT_EQ(regions[0].area, area_of(prepared, left));
  const SurfaceIndex surface(prepared.mesh, left);
  for (const int face : left) {
    for (int k = 0; k < 3; ++k) {
      const Vector3d corner = prepared.mesh.vertices.row(mesh.faces(face, k));
      for (const Motion& motion : motions) EXPECT_TRUE(surface.within(motion(corner), kTolerance));
    }
  }
  // What goes lies on the bump, or within four edges of it or of one of its images.
  std::vector<int> gone;
  std::ranges::set_difference(test::all_faces(mesh), left, std::back_inserter(gone));
  for (const int face : gone) {
    const Vector3d centroid = mesh.vertices(mesh.faces.row(face), Eigen::all).colwise().mean();
    double nearest = (centroid.head<2>() - kBumpAt).norm();
    for (const Motion& motion : motions) {
      nearest = std::min(nearest, ((motion.linear * centroid).head<2>() - kBumpAt).norm());
    }
    EXPECT_LT(nearest, kBump + 4.0 / kCells) << centroid.transpose();
  }
}

INSTANTIATE_TEST_SUITE_P(Groups, TrimmedRegions, testing::Values("C2", "C2v", "C4", "D4"));

TEST(TrimRegions, LeaveAloneWhatIsExact) {
  const Mesh mesh = test::sheet(kCells, [](double, double) { return 0.0; });
  const PreparedMesh prepared = prepare(mesh);
  std::vector<FoundRegion> regions{region_of(prepared, "C4v", test::all_faces(mesh))};
  trim_regions(prepared, kTolerance, BorderMoves::both_ways, RunContext{}, regions);
  EXPECT_EQ(regions[0].faces, test::all_faces(mesh));
  ASSERT_TRUE(regions[0].residual);
  EXPECT_LT(regions[0].residual->max, 1e-12);
}

TEST(TrimRegions, LeaveAloneWhatWouldLoseMoreThanATenth) {
  // A quarter of the sheet is raised: of C4 nothing would be left there or opposite.
  const Mesh mesh = test::sheet(kCells, [](double x, double y) { return x > 0 && y > 0 ? 0.05 : 0.0; });
  const PreparedMesh prepared = prepare(mesh);
  std::vector<FoundRegion> regions{region_of(prepared, "C4", test::all_faces(mesh))};
  Explanation explanation;
  trim_regions(prepared, kTolerance, BorderMoves::both_ways, RunContext{}, regions, &explanation);
  EXPECT_EQ(regions[0].faces, test::all_faces(mesh));
  ASSERT_EQ(explanation.notes.size(), 1U);
}

TEST(TrimRegions, LeaveAloneWhatThereIsNoTimeFor) {
  const Mesh mesh = bumpy();
  const PreparedMesh prepared = prepare(mesh);
  std::vector<FoundRegion> regions(2, region_of(prepared, "C2", test::all_faces(mesh)));
  for (FoundRegion& region : regions) region.placement.centre = inverse(prepared.input_of_normalised)(Vector3d::Zero());
  int asked = 0;
  trim_regions(prepared, kTolerance, BorderMoves::both_ways, RunContext{}, regions, nullptr,
               [&] { return ++asked > 1; });
  EXPECT_LT(regions[0].faces.size(), regions[1].faces.size());
  EXPECT_EQ(regions[1].faces, test::all_faces(mesh));
}

TEST(TrimRegions, SameForAnyNumberOfThreads) {
  const Mesh mesh = bumpy();
  const PreparedMesh prepared = prepare(mesh);
  RunContext three;
  three.threads = 3;
  std::vector<FoundRegion> one{region_of(prepared, "C4v", test::all_faces(mesh))};
  std::vector<FoundRegion> other = one;
  trim_regions(prepared, kTolerance, BorderMoves::both_ways, RunContext{}, one);
  trim_regions(prepared, kTolerance, BorderMoves::both_ways, three, other);
  EXPECT_EQ(one[0].faces, other[0].faces);
}

}  // namespace
}  // namespace orbifit

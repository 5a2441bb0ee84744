#include "group/surroundings.h"

#include <algorithm>
#include <limits>
#include <numbers>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "group/verification.h"
#include "shapes.h"

namespace orbifit {
namespace {

using Eigen::Vector3d;

// A hexagonal stud on a plate of two triangles a side, its axis at (0.5, 0.3).
class Surroundings : public testing::Test {
 protected:
  Surroundings()
      : prepared_(prepare(test::joined({test::box(4, 4, 0.2), test::moved(test::prism(6, 0.15, 0.3), stud_)}))),
        placement_{*PointGroup::parse("C6v"), GroupFrame::Identity(),
                   inverse(prepared_.input_of_normalised)(stud_.translation)},
        seeds_(12) {
    std::iota(seeds_.begin(), seeds_.end(), 12);  // the stud's sides
    patch_ = surroundings(prepared_, prepared_.index, placement_, seeds_, 0.005, RunContext{});
  }

  Vector3d centroid(int face) const {
    return prepared_.mesh.vertices(prepared_.mesh.faces.row(face), Eigen::all).colwise().mean();
  }

  const Motion stud_ = test::shift(0.5, 0.3, 0.25);
  PreparedMesh prepared_;
  GroupPlacement placement_;
  std::vector<int> seeds_;
  SurfacePatch patch_;
};

TEST_F(Surroundings, HoldOfALargeTriangleWhatIsNear) {
  double reach = 0;  // from the axis
  std::vector<Vector3d> images;
  for (const int seed : seeds_) {
    reach = std::max(reach, (centroid(seed) - placement_.centre).head<2>().norm());
    images.push_back(centroid(seed));
    for (const Motion& motion : judged_motions(placement_.group, placement_.frame, placement_.centre)) {
      images.push_back(motion(centroid(seed)));
    }
  }
  ASSERT_GT(patch_.samples.points.rows(), 1000);
  EXPECT_LT(patch_.samples.points.rows(), 2000);
  std::vector<int> of_plate;
  for (Eigen::Index i = 0; i < patch_.samples.points.rows(); ++i) {
    const Vector3d point = patch_.samples.points.row(i);
    double nearest = std::numeric_limits<double>::infinity();
    for (const Vector3d& image : images) nearest = std::min(nearest, (point - image).norm());
    EXPECT_LE(nearest, reach + 1e-9);
    const int face = patch_.samples.faces[static_cast<std::size_t>(i)];
    if (face < 12) of_plate.push_back(face);
  }
  EXPECT_GT(of_plate.size(), 100U);
  EXPECT_TRUE(std::ranges::is_sorted(patch_.faces));
  EXPECT_LT(patch_.moments.diagonal, 6 * reach);
  EXPECT_LT((patch_.moments.centroid - placement_.centre).head<2>().norm(), 0.02 * reach);
}

TEST_F(Surroundings, AreKeptByTheGroupAndNotByAnother) {
  for (const Motion& motion : judged_motions(placement_.group, placement_.frame, placement_.centre)) {
    EXPECT_EQ(kept_share(patch_, motion, patch_.tolerance, 0), 1);
  }
  const Motion between = Motion::rotation(Vector3d::UnitZ(), std::numbers::pi / 6, placement_.centre);
  EXPECT_LT(kept_share(patch_, between, patch_.tolerance, 0), 0.95);
}

}  // namespace
}  // namespace orbifit

#include "scan/clutter.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/datasets_tools/virtual_scan.h"

#include "base/random.h"

namespace orbifit {
namespace {

// A model scanned on a floor with blocks beside it.
class Cluttered : public testing::TestWithParam<const char*> {
 protected:
  Cluttered() : model_(generate(GetParam())), surface_(model_.mesh), size_(diagonal(model_.mesh.vertices)) {
    ScanOptions options;
    options.views = 2;
    options.elevation = 30;
    options.clutter = 0.3;
    scan_ = virtual_scan(model_.mesh, options, context_);
  }

  bool own(const Eigen::Vector3d& point) const { return surface_.within(point, 1e-5 * size_); }

  RunContext context_;
  GeneratedModel model_;
  SurfaceIndex surface_;
  double size_;
  PointCloud scan_;
};

TEST_P(Cluttered, ScanHoldsTheShareAskedFor) {
  Eigen::Index others = 0;
  for (Eigen::Index i = 0; i < scan_.points.rows(); ++i) others += own(scan_.points.row(i)) ? 0 : 1;
  EXPECT_NEAR(static_cast<double>(others) / static_cast<double>(scan_.points.rows()), 0.3, 0.03);
}

TEST_P(Cluttered, NearPointsAreAllThatAreNear) {
  const PointCloud near = points_near(surface_, size_, scan_, Similarity{}, 0.1, context_);
  Eigen::Index expected = 0;
  for (Eigen::Index i = 0; i < scan_.points.rows(); ++i) {
    expected += surface_.nearest(scan_.points.row(i)).distance <= 0.1 * size_ ? 1 : 0;
  }
  EXPECT_EQ(near.points.rows(), expected);
  EXPECT_EQ(near.viewpoints.rows(), expected);
  EXPECT_LT(expected, scan_.points.rows());
}

TEST_P(Cluttered, TheFloorGoesAndTheShapeStays) {
  const PreparedScan scan = prepare_scan(scan_, {}, context_);
  const PreparedScan left = without_planes(surface_, size_, scan, Similarity{}, 0.035, context_);
  const auto count = [&](const PreparedScan& of) {
    std::pair<int, int> result{0, 0};  // of the shape, of the floor
    for (Eigen::Index i = 0; i < of.points.rows(); ++i) {
      if (own(of.points.row(i)))
        ++result.first;
      else if (of.points(i, 2) < 0.001 * size_)
        ++result.second;
    }
    return result;
  };
  const auto [shape, floor] = count(scan);
  const auto [shape_left, floor_left] = count(left);
  ASSERT_GT(floor, 500);
  EXPECT_LT(floor_left, 0.03 * floor);
  EXPECT_GT(shape_left, 0.93 * shape);
  EXPECT_EQ(left.normals.rows(), left.points.rows());
}

TEST_P(Cluttered, OfAFloorAloneNothingIsLeft) {
  PointCloud floor;
  floor.points.resize(4000, 3);
  Random random(3);
  for (Eigen::Index i = 0; i < floor.points.rows(); ++i) {
    floor.points.row(i) << size_ * random.uniform(-1, 1), size_ * random.uniform(-1, 1), -0.001 * size_;
  }
  const PreparedScan scan = prepare_scan(floor, {}, context_);
  EXPECT_EQ(without_planes(surface_, size_, scan, Similarity{}, 0.035, context_).points.rows(), 0);
}

TEST_P(Cluttered, AShapeAloneLosesNothing) {
  ScanOptions options;
  options.views = 2;
  const PreparedScan scan = prepare_scan(virtual_scan(model_.mesh, options, context_), {}, context_);
  EXPECT_EQ(without_planes(surface_, size_, scan, Similarity{}, 0.035, context_).points.rows(), scan.points.rows());
}

INSTANTIATE_TEST_SUITE_P(Models, Cluttered, testing::Values("chair", "table", "armchair"),
                         [](const auto& each) { return std::string(each.param); });

}  // namespace
}  // namespace orbifit

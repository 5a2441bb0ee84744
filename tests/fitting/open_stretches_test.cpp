#include "assessment/open_stretches.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "base/random.h"
#include "support/cuboid.h"

namespace orbifit {
namespace {

using Eigen::Vector3d;

class OpenStretches : public testing::Test {
 protected:
  OpenStretches() {
    result_.fitted = cuboid();
    std::vector<int> all(static_cast<std::size_t>(result_.fitted.faces.rows()));
    std::iota(all.begin(), all.end(), 0);
    result_.annotation = empty_annotation(result_.fitted, 0.005);
    result_.annotation.regions.push_back(
        make_region(*PointGroup::parse("D2h"), Vector3d::Zero(), GroupFrame::Identity(), all, "cuboid"));
  }

  // Of a scan of some sides, taken from a place or nobody knows whence.
  std::vector<OpenStretch> open(const std::vector<int>& sides, const Vector3d* from = nullptr,
                                const FitOptions& options = {}) const {
    const PreparedScan scan = scan_of_faces(result_.fitted, sides);
    PointCloud cloud;
    cloud.points = scan.points;
    if (from != nullptr) cloud.viewpoints = from->transpose().replicate(scan.points.rows(), 1);
    return open_stretches(scan, SeenSurface(cloud, scan.points), options, RunContext{}, result_);
  }

  // Those that a fit of a noisy scan would not have anyway.
  static std::vector<OpenStretch> wide(std::vector<OpenStretch> open) {
    std::erase_if(open, [](const OpenStretch& each) { return each.most() < 0.05; });
    return open;
  }

  static double most(const std::vector<OpenStretch>& open) { return open.empty() ? 0 : open.front().most(); }

  FitResult result_;
};

TEST_F(OpenStretches, AreNextToNoneWhereAllIsSeen) {
  EXPECT_LT(most(open({0, 1, 2, 3, 4, 5})), 0.02);
}

// As the noise grows little by little, so does what it leaves open.
TEST_F(OpenStretches, ChangeLittleWhereTheScanDoes) {
  constexpr double kStep = 1.05;
  const PreparedScan exact = scan_of_faces(result_.fitted, {0, 1, 2, 3, 4, 5});
  double before = most(open({0, 1, 2, 3, 4, 5}));
  double largest = 0;
  for (double noise = 0.002; noise < 0.06; noise *= kStep) {
    Random random(1, "noise of a scan");
    PreparedScan scan = exact;
    for (double& coordinate : scan.points.reshaped()) coordinate += noise * random.normal();
    PointCloud cloud;
    cloud.points = scan.points;
    const double now = most(open_stretches(scan, SeenSurface(cloud, scan.points), {}, RunContext{}, result_));
    EXPECT_LT(std::abs(now - before), 0.02) << noise;
    before = now;
    largest = std::max(largest, now);
  }
  EXPECT_GT(largest, 0.05);
}

// Nothing says where faces end that no view limits; but they are no smaller than what was seen of them.
TEST_F(OpenStretches, OfThreeFacesAreLongerOnesAlone) {
  const std::vector<OpenStretch> found = open({1, 3, 5});
  EXPECT_EQ(found.size(), 4U);
  for (const OpenStretch& each : found) {
    EXPECT_LT(each.shorter, 0.05);
    EXPECT_EQ(each.longer, 0.2);
  }
}

TEST_F(OpenStretches, EndWhereTheViewpointShouldHaveSeenMore) {
  const Vector3d from(8, 7, 6);
  const std::vector<OpenStretch> found = open({1, 3, 5}, &from);
  ASSERT_FALSE(found.empty());
  EXPECT_LT(most(found), 0.2);
  // The longest side, of which a twentieth is more than what counts as seen beyond a point.
  for (const OpenStretch& each : found) EXPECT_TRUE(each.along(0, 0) < 0.5 || each.most() < 0.1);
}

TEST_F(OpenStretches, AlongOneAxisAreTold) {
  const std::vector<OpenStretch> found = wide(open({2, 3, 4, 5}));  // a tube: open at both ends of x
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR((found[0].along * Vector3d::UnitX() - Vector3d::UnitX()).norm(), 0, 1e-6);
  EXPECT_NEAR(found[0].along.trace(), 1, 1e-12);
}

TEST_F(OpenStretches, OfATemplateOfFixedSizeAreNotOfAllOfIt) {
  FitOptions options;
  options.fixed_scale = true;
  const std::vector<OpenStretch> found = wide(open({1, 3, 5}, nullptr, options));
  EXPECT_EQ(found.size(), 3U);
  for (const OpenStretch& each : found) EXPECT_NEAR(each.along.trace(), 1, 1e-12);
}

// A group that turns two axes into one another leaves one way to stretch them.
TEST_F(OpenStretches, KeepTheGroupOfTheWhole) {
  Region& region = result_.annotation.regions.front();
  region = make_region(*PointGroup::parse("Cinfv"), Vector3d::Zero(), GroupFrame::Identity(), region.faces, "round");
  const std::vector<OpenStretch> found = open({5});
  EXPECT_EQ(found.size(), 3U);  // all of it, along the axis, across it
  for (const OpenStretch& each : found) {
    EXPECT_NEAR((each.along * Vector3d::UnitZ() - each.along(2, 2) * Vector3d::UnitZ()).norm(), 0, 1e-6);
    EXPECT_NEAR(each.along(0, 0), each.along(1, 1), 1e-6);
  }
}

}  // namespace
}  // namespace orbifit

#include "evidence/near_points.h"

#include <cmath>
#include <cstddef>
#include <random>
#include <string>

#include <gtest/gtest.h>

namespace orbifit {
namespace {

int first_by_asking_all(const NearPoints& points, const Eigen::Vector3d& point, double reach) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    if ((points[i] - point).squaredNorm() <= reach * reach) return static_cast<int>(i);
  }
  return -1;
}

class NearPointsOfEdge : public testing::TestWithParam<double> {};

// In a box of this edge, in reaches: crowded, and almost alone; while the points become more.
TEST_P(NearPointsOfEdge, FindsTheFirstOfThoseWithinReach) {
  constexpr double kReach = 0.01;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> coordinate(-0.5 * GetParam() * kReach, 0.5 * GetParam() * kReach);
  const auto some = [&] { return Eigen::Vector3d(coordinate(random), coordinate(random), coordinate(random)); };
  NearPoints points(kReach);
  int found = 0;
  int none = 0;
  for (int i = 0; i < 600; ++i) {
    const Eigen::Vector3d point = some();
    const int first = points.first_near(point);
    ASSERT_EQ(first, first_by_asking_all(points, point, kReach)) << i;
    ++(first < 0 ? none : found);
    points.add(point);
    ASSERT_EQ(points.size(), static_cast<std::size_t>(i) + 1);
    ASSERT_EQ(points.first_near(point), first < 0 ? i : first);
  }
  EXPECT_GT(found, 5);
  EXPECT_GT(none, 5);
}

INSTANTIATE_TEST_SUITE_P(NearPoints, NearPointsOfEdge, testing::Values(5.0, 15.0, 30.0),
                         [](const auto& instance) { return std::to_string(std::lround(instance.param)); });

TEST(NearPoints, HaveNoneAtFirstAndNoneForNoNumber) {
  NearPoints points(1);
  EXPECT_EQ(points.first_near(Eigen::Vector3d::Zero()), -1);
  for (int i = 0; i < 40; ++i) points.add(Eigen::Vector3d(3.0 * i, 0, 0));
  EXPECT_EQ(points.first_near(Eigen::Vector3d::Constant(std::nan(""))), -1);
  EXPECT_EQ(points.first_near(Eigen::Vector3d(-1, 0, 0)), 0);  // at the reach
  EXPECT_EQ(points.first_near(Eigen::Vector3d(1e30, 0, 0)), -1);
}

}  // namespace
}  // namespace orbifit

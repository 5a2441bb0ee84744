#include "geometry/fitted_plane.h"

#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "base/random.h"

namespace orbifit {
namespace {

using Eigen::Vector3d;

std::vector<int> all_of(const Points& points) {
  std::vector<int> result(static_cast<std::size_t>(points.rows()));
  std::iota(result.begin(), result.end(), 0);
  return result;
}

class PlaneAt : public testing::TestWithParam<double> {};

// Points of a tilted rectangle far from the origin, whose deviations are known: a side over the square root of twelve.
TEST_P(PlaneAt, IsThePointsOwnToRounding) {
  const double far = GetParam();
  const Vector3d u = Vector3d(1, 2, 2) / 3;
  const Vector3d v = Vector3d(2, 1, -2) / 3;
  const Vector3d centre = far * Vector3d(1, -2, 0.5);
  constexpr int kSteps = 101;
  Points points(kSteps * kSteps, 3);
  for (int i = 0; i < points.rows(); ++i) {
    const double a = static_cast<double>(i / kSteps) / (kSteps - 1) - 0.5;
    const double b = static_cast<double>(i % kSteps) / (kSteps - 1) - 0.5;
    points.row(i) = (centre + 2 * a * u + b * v).transpose();
  }
  const FittedPlane plane = fitted_plane(points, all_of(points));
  const double rounding = 1e-13 * (1 + far);
  EXPECT_NEAR(std::abs(plane.normal.dot(u.cross(v))), 1, rounding);
  EXPECT_LT((plane.point - centre).norm(), 10 * rounding);
  EXPECT_LT(plane.deviations[0], 10 * std::sqrt(kSteps) * rounding);
  const double ends = std::sqrt((kSteps + 1.0) / (kSteps - 1.0));  // of so many even steps, not of a continuum
  EXPECT_NEAR(plane.deviations[1], ends / std::sqrt(12), 10 * rounding);
  EXPECT_NEAR(plane.deviations[2], 2 * ends / std::sqrt(12), 10 * rounding);
}

INSTANTIATE_TEST_SUITE_P(Offsets, PlaneAt, testing::Values(0.0, 1e4));

TEST(FittedPlane, HeedsOnlyTheChosenPoints) {
  Points points(6, 3);
  points << 0, 0, 1, 1, 0, 1, 5, -3, 9, 0, 1, 1, 1, 1, 1, -7, 2, 4;
  const FittedPlane plane = fitted_plane(points, {0, 1, 3, 4});
  EXPECT_NEAR(std::abs(plane.normal.z()), 1, 1e-15);
  EXPECT_NEAR((plane.point - Vector3d(0.5, 0.5, 1)).norm(), 0, 1e-15);
}

TEST(FittedPlane, MeasuresTheNoiseAcross) {
  Random random(5);
  Points points(4000, 3);
  for (int i = 0; i < points.rows(); ++i)
    points.row(i) << random.uniform(-1, 1), 0.01 * random.normal(), random.uniform(-1, 1);
  const FittedPlane plane = fitted_plane(points, all_of(points));
  EXPECT_GT(std::abs(plane.normal.y()), 0.9999);
  EXPECT_NEAR(plane.deviations[0], 0.01, 5e-4);
}

TEST(FittedPlane, OfPointsWithoutAPlaneHasAUnitNormalStill) {
  Points line(3, 3);
  line << 0, 0, 0, 1, 1, 1, 2, 2, 2;
  const FittedPlane across = fitted_plane(line, {0, 1, 2});
  EXPECT_NEAR(across.normal.norm(), 1, 1e-14);
  EXPECT_NEAR(across.normal.sum(), 0, 1e-14);
  EXPECT_NEAR(fitted_plane(line, {1}).normal.norm(), 1, 1e-14);
  EXPECT_EQ(fitted_plane(line, {1}).deviations.maxCoeff(), 0);
}

}  // namespace
}  // namespace orbifit

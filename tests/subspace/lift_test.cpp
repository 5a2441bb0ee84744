#include "orbifit/subspace/lift.h"

#include <gtest/gtest.h>

#include "orbifit/model/random.h"

namespace orbifit {
namespace {

Points random_points(int count, Random& random) {
  Points points(count, 3);
  for (double& coordinate : points.reshaped()) coordinate = random.uniform(-1, 1);
  return points;
}

TEST(Lift, IsAPartitionOfUnity) {
  Random random(5);
  const LiftWeights weights = lift_weights(random_points(500, random), random_points(40, random), 0.3, RunContext{});
  for (Eigen::Index row = 0; row < weights.rows(); ++row) {
    EXPECT_NEAR(weights.row(row).sum(), 1, 1e-14);
    for (LiftWeights::InnerIterator entry(weights, row); entry; ++entry) EXPECT_GT(entry.value(), 0);
  }
}

TEST(Lift, PointsOutOfReachFollowTheNearestSample) {
  Random random(6);
  Points samples = random_points(10, random);
  Points far(1, 3);
  far << 100, 0, 0;
  const LiftWeights weights = lift_weights(far, samples, 0.1, RunContext{});
  int nearest = 0;
  (samples.rowwise() - far.row(0)).rowwise().norm().minCoeff(&nearest);
  EXPECT_EQ(weights.nonZeros(), 1);
  EXPECT_EQ(weights.coeff(0, nearest), 1);
}

TEST(Lift, IsContinuousWhereAGaussianIsCutOff) {
  Points samples(2, 3);
  samples << 0, 0, 0, 3, 0, 0;
  const double cut = std::sqrt(-2 * std::log(0.001));
  Points points(2, 3);
  points << cut - 1e-7, 0, 0, cut + 1e-7, 0, 0;
  const LiftWeights weights = lift_weights(points, samples, 1, RunContext{});
  EXPECT_NEAR(weights.coeff(0, 0), weights.coeff(1, 0), 1e-6);
}

TEST(Lift, DoesNotDependOnThreads) {
  Random random(7);
  const Points points = random_points(3000, random);
  const Points samples = random_points(100, random);
  RunContext two;
  two.threads = 2;
  const LiftWeights a = lift_weights(points, samples, 0.3, RunContext{});
  const LiftWeights b = lift_weights(points, samples, 0.3, two);
  EXPECT_EQ(Eigen::MatrixXd(a), Eigen::MatrixXd(b));
}

}  // namespace
}  // namespace orbifit

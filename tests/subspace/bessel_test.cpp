#include "basis/bessel.h"

#include <cmath>

#include <gtest/gtest.h>

namespace orbifit {
namespace {

// Of exp(kappa (cos - 1)) and of cos under that weight, around a circle: the trapezoid rule converges exponentially.
GaussianAverage circle_quadrature(double kappa) {
  constexpr int kSteps = 4096;
  double weight = 0;
  double along = 0;
  for (int k = 0; k < kSteps; ++k) {
    const double cosine = std::cos(2 * M_PI * k / kSteps);
    const double value = std::exp(kappa * (cosine - 1)) / kSteps;
    weight += value;
    along += cosine * value;
  }
  return {weight, along / weight};
}

// Over a sphere, where the cosine is uniform in [-1, 1] (Archimedes): Simpson's rule in s, cosine = 1 - 2 s^2, which is
// denser where the weight is.
GaussianAverage sphere_quadrature(double kappa) {
  constexpr int kSteps = 20000;
  double weight = 0;
  double along = 0;
  for (int k = 0; k <= kSteps; ++k) {
    const double s = static_cast<double>(k) / kSteps;
    const double simpson = (k == 0 || k == kSteps ? 1.0 : k % 2 == 1 ? 4.0 : 2.0) / (3.0 * kSteps);
    const double cosine = 1 - 2 * s * s;
    const double value = simpson * 2 * s * std::exp(-2 * kappa * s * s);
    weight += value;
    along += cosine * value;
  }
  return {weight, along / weight};
}

class GaussianAverages : public testing::TestWithParam<double> {};

TEST_P(GaussianAverages, AroundACircleIsTheIntegral) {
  const GaussianAverage due = circle_quadrature(GetParam());
  const GaussianAverage average = circle_average(GetParam());
  EXPECT_NEAR(average.weight, due.weight, 1e-10 * due.weight);
  EXPECT_NEAR(average.ratio, due.ratio, 1e-10);
}

TEST_P(GaussianAverages, OverASphereIsTheIntegral) {
  const GaussianAverage due = sphere_quadrature(GetParam());
  const GaussianAverage average = sphere_average(GetParam());
  EXPECT_NEAR(average.weight, due.weight, 1e-9 * due.weight);
  EXPECT_NEAR(average.ratio, due.ratio, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Kappas, GaussianAverages,
                         testing::Values(0, 1e-8, 9.9e-4, 1.01e-3, 0.03, 0.7, 3, 20, 150, 199.9, 200.1, 700, 5e3));

TEST(GaussianAverages, StayFiniteWhereTheBesselFunctionsDoNot) {
  for (const double kappa : {1e4, 1e6, 1e9}) {
    for (const GaussianAverage& average : {circle_average(kappa), sphere_average(kappa)}) {
      EXPECT_GT(average.weight, 0);
      EXPECT_LT(average.weight, 1);
      EXPECT_LE(average.ratio, 1);
      EXPECT_GT(average.ratio, 1 - 2 / kappa);
    }
  }
}

}  // namespace
}  // namespace orbifit

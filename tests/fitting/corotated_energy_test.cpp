#include "solver/corotated_energy.h"

#include <cmath>

#include <gtest/gtest.h>

#include "orbifit/model/motion.h"

#include "base/random.h"

namespace orbifit {
namespace {

class Samples : public testing::TestWithParam<int> {
 protected:
  Samples() : points_(80, 3) {
    for (auto point : points_.rowwise()) {
      point << random_.uniform(), random_.uniform(), random_.uniform();
    }
  }

  Random random_{static_cast<std::uint64_t>(GetParam())};
  Points points_;
};

TEST_P(Samples, GrowthCostsWhatThatStretchingDoes) {
  const CorotatedEnergy energy(points_, 0.12, 0.3);
  const Eigen::RowVector3d centre(1, -2, 0.5);
  for (const double growth : {-0.2, 0.01, 0.3}) {
    const Points stretched = growth * (points_.rowwise() - centre);
    EXPECT_NEAR(energy.value(stretched), growth * growth * energy.of_growth(), 1e-12);
  }
  EXPECT_GT(energy.of_growth(), 0);
}

TEST_P(Samples, MotionsCostNothing) {
  CorotatedEnergy energy(points_, 0.12, 0.3);
  const Motion motion = Motion::rotation(random_.direction(), 0.4, random_.direction());
  Points moved(points_.rows(), 3);
  for (Eigen::Index i = 0; i < points_.rows(); ++i) {
    moved.row(i) = (motion(points_.row(i).transpose()) - points_.row(i).transpose()).transpose();
  }
  EXPECT_GT(energy.value(moved), 1e-3);
  energy.rotate(moved);
  EXPECT_NEAR(energy.value(moved), 0, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Seeds, Samples, testing::Values(1, 2, 3));

}  // namespace
}  // namespace orbifit

#include "orbifit/model/motion.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "base/random.h"

namespace orbifit {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kPi = std::numbers::pi;

Vector3d point(Random& random) {
  const double length = random.uniform(0.1, 2);
  return length * random.direction();
}

class AxisAngleOf : public testing::TestWithParam<double> {};

// Also where sine or cosine says next to nothing of the angle, and with a reflection besides.
TEST_P(AxisAngleOf, GivesTheRotationBack) {
  Random random(3, "axis angle");
  for (const int determinant : {1, -1}) {
    for (int i = 0; i < 20; ++i) {
      const Vector3d axis = point(random).normalized();
      const Matrix3d linear = determinant * axis_rotation(axis, GetParam());
      const AxisAngle found = axis_angle(linear);
      EXPECT_EQ(found.determinant, determinant);
      EXPECT_NEAR(found.angle, GetParam(), 1e-12);
      EXPECT_LT((found.determinant * axis_rotation(found.axis, found.angle) - linear).norm(), 1e-12);
      if (GetParam() < kPi) {
        EXPECT_LT((found.axis - axis).norm(), 1e-15 / std::sin(GetParam()) + 1e-11);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Angles, AxisAngleOf,
                         testing::Values(1e-6, 1e-3, 0.5, 0.5 * kPi, 2.0, kPi - 1e-2, kPi - 1.1e-3, kPi - 9e-4,
                                         kPi - 1e-6, kPi));

struct Similarities {
  Random random{5, "similarities"};
  Similarity a{2.5, random.rotation(), point(random)}, b{0.3, random.rotation(), point(random)};
  Vector3d p = point(random);
};

TEST(Similarity, ProductsGoOneAfterTheOther) {
  const Similarities s;
  EXPECT_LT(((s.a * s.b)(s.p) - s.a(s.b(s.p))).norm(), 1e-14);
}

TEST(Similarity, InverseTakesBack) {
  const Similarities s;
  EXPECT_LT((inverse(s.a)(s.a(s.p)) - s.p).norm(), 1e-14);
  EXPECT_LT((s.b(inverse(s.b)(s.p)) - s.p).norm(), 1e-14);
}

TEST(Similarity, ConjugateDoesThereWhatTheMotionDoesHere) {
  Similarities s;
  const Motion motion{s.random.rotation(), point(s.random)};
  for (const Similarity& similarity : {s.a, s.b}) {
    EXPECT_LT((conjugate(similarity, motion)(similarity(s.p)) - similarity(motion(s.p))).norm(), 1e-14);
  }
}

}  // namespace
}  // namespace orbifit

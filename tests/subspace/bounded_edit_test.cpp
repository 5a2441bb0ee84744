#include "deformation/bounded_edit.h"

#include <gtest/gtest.h>

namespace orbifit {
namespace {

// A handle, asked to move by 1, sees one of two coordinates by `lever`, as nothing else does.
struct Lever {
  explicit Lever(double length) : lever(length, 0) {
    columns.insert(0, 0) = 2;
    columns.insert(1, 0) = 1;
    columns.insert(2, 1) = 1;
  }

  // Least squares of weight (lever q - 1)^2 + held |q|^2.
  Eigen::Vector2d solution(double held) const {
    const Eigen::Matrix2d system = weight * lever * lever.transpose() + held * Eigen::Matrix2d::Identity();
    return system.ldlt().solve(weight * lever);
  }

  double weight = 1e6;
  Eigen::Vector2d lever;
  Eigen::SparseMatrix<double> columns{3, 2};
  BoundedEdit bound{1, Eigen::Vector3d(1, 0, 0)};
};

class BoundedEditByLever : public testing::TestWithParam<double> {};

TEST_P(BoundedEditByLever, StaysWithinReach) {
  const Lever lever(GetParam());
  const Eigen::Vector2d free = lever.solution(1e-12 * lever.weight * GetParam() * GetParam());
  ASSERT_TRUE(lever.bound.exceeded(lever.columns, free));
  const Eigen::Vector2d held = lever.solution(lever.bound.weight(lever.columns, lever.weight));
  EXPECT_FALSE(lever.bound.exceeded(lever.columns, held));
  EXPECT_LE((lever.columns * held).cwiseAbs().maxCoeff(), 100);
  EXPECT_GT(held[0], 0);  // it still goes that way
}

INSTANTIATE_TEST_SUITE_P(Levers, BoundedEditByLever, testing::Values(1e-3, 1e-6, 1e-9));

TEST(BoundedEdit, LetsFarHandlesBeFollowed) {
  const Lever near(0.1);
  EXPECT_FALSE(near.bound.exceeded(near.columns, near.solution(1e-6)));
  const BoundedEdit far(1, Eigen::Vector3d(0, -1000, 0));
  EXPECT_FALSE(far.exceeded(near.columns, Eigen::Vector2d(1000, 0)));
  EXPECT_TRUE(far.exceeded(near.columns, Eigen::Vector2d(200000, 0)));
}

}  // namespace
}  // namespace orbifit

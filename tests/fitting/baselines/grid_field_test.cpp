#include "grid_field.h"

#include <vector>

#include <gtest/gtest.h>

#include "base/random.h"

namespace orbifit {
namespace {

Points random_points(int count, Random& random) {
  Points points(count, 3);
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    points.row(i) << random.uniform(-0.4, 0.4), random.uniform(-0.25, 0.25), random.uniform(-0.5, 0.5);
  }
  return points;
}

class GridField : public testing::TestWithParam<GridBasis> {
 protected:
  Random random_{3};
  Points points_ = random_points(500, random_);
  Grid grid_ = grid_around(points_, 0.1, GetParam());
};

TEST_P(GridField, FunctionsSumToOneAndAreNotNegativeOnTheCells) {
  const SparseRows values = basis_values(grid_, points_);
  EXPECT_LT((values * Eigen::VectorXd::Ones(values.cols()) - Eigen::VectorXd::Ones(values.rows())).norm(), 1e-13);
  EXPECT_GE(Eigen::Map<const Eigen::VectorXd>(values.valuePtr(), values.nonZeros()).minCoeff(), 0);
  EXPECT_EQ(values.nonZeros(), points_.rows() * (GetParam() == GridBasis::linear ? 8 : 64));
}

TEST_P(GridField, ReproducesAffineFieldsWithinTheCellsAndOutside) {
  const Eigen::Matrix3d linear = Eigen::Matrix3d::NullaryExpr([&] { return random_.uniform(-1, 1); });
  const Eigen::Vector3d translation(0.3, -0.2, 0.5);
  const Points coefficients = affine_coefficients(grid_, linear, translation);
  const Points beyond = 1.5 * points_;
  for (const Points& points : std::vector<Points>{points_, beyond}) {
    const Points expected = (points * linear.transpose()).rowwise() + translation.transpose();
    EXPECT_LT((basis_values(grid_, points) * coefficients - expected).norm(), 1e-12);
  }
}

TEST_P(GridField, HoldsThePointsWithHalfASpacingToSpareAboutTheirCentre) {
  const Eigen::Vector3d end = grid_.corner + (grid_.spacing * grid_.cells.cast<double>()).matrix();
  const Eigen::Vector3d low = points_.colwise().minCoeff();
  const Eigen::Vector3d high = points_.colwise().maxCoeff();
  EXPECT_GT((low - grid_.corner).minCoeff(), 0.5 * grid_.spacing - 1e-9);
  EXPECT_LT((low - grid_.corner).maxCoeff(), grid_.spacing + 1e-9);
  EXPECT_LT((end - high - (low - grid_.corner)).norm(), 1e-14);
}

INSTANTIATE_TEST_SUITE_P(Bases, GridField, testing::Values(GridBasis::linear, GridBasis::cubic),
                         [](const auto& each) { return each.param == GridBasis::linear ? "linear" : "cubic"; });

}  // namespace
}  // namespace orbifit

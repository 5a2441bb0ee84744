#include "thin_plate.h"

#include <gtest/gtest.h>

#include "base/dense.h"

namespace orbifit {
namespace {

Grid small_grid(GridBasis basis) {
  Grid grid;
  grid.corner = {-0.3, 0.1, 0.2};
  grid.spacing = 0.1;
  grid.cells = {3, 4, 5};
  grid.basis = basis;
  return grid;
}

class ThinPlate : public testing::TestWithParam<GridBasis> {
 protected:
  Grid grid_ = small_grid(GetParam());
  Eigen::SparseMatrix<double> plate_ = thin_plate(grid_);
};

TEST_P(ThinPlate, IsZeroForAffineFunctionsAlone) {
  const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(Eigen::MatrixXd(plate_)).eigenvalues();
  EXPECT_LT(values.head<4>().cwiseAbs().maxCoeff(), 1e-12 * values.maxCoeff());
  EXPECT_GT(values[4], 1e-8 * values.maxCoeff());
  Eigen::Matrix3d linear;
  linear << 1, 2, 3, 4, 5, 6, 7, 8, 10;
  EXPECT_LT((plate_ * affine_coefficients(grid_, linear, {1, 2, 3})).norm(), 1e-9);
}

TEST_P(ThinPlate, IsTheProductOfItsRows) {
  const SparseRows rows = thin_plate_rows(grid_);
  const Eigen::MatrixXd product = rows.transpose() * rows;
  EXPECT_LT((product - Eigen::MatrixXd(plate_)).norm(), 1e-12 * product.norm());
}

// f = x^T A x / 2 + ... has the Hessian A: the integral is volume |A|^2.
TEST_P(ThinPlate, OfAQuadraticIsItsHessiansSquareTimesTheVolume) {
  Eigen::Matrix3d hessian;
  hessian << 2, -1, 0.5, -1, 3, 0.25, 0.5, 0.25, -1.5;
  const Points places = affine_coefficients(grid_, Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero());
  // Coefficients of cubic B-splines for x^2 are those of the places less a constant, which has no Hessian.
  const Eigen::VectorXd coefficients = 0.5 * (places * hessian).cwiseProduct(places).rowwise().sum();
  const double volume = std::pow(grid_.spacing, 3) * grid_.cells.prod();
  double expected = volume * hessian.squaredNorm();
  if (GetParam() == GridBasis::linear) {
    // Second differences stand for the inner nodes of their axis alone.
    for (int a = 0; a < 3; ++a) expected -= volume / grid_.cells[a] * hessian(a, a) * hessian(a, a);
  }
  EXPECT_NEAR(coefficients.dot(plate_ * coefficients), expected, 1e-10 * expected);
}

INSTANTIATE_TEST_SUITE_P(Bases, ThinPlate, testing::Values(GridBasis::linear, GridBasis::cubic),
                         [](const auto& each) { return each.param == GridBasis::linear ? "linear" : "cubic"; });

}  // namespace
}  // namespace orbifit

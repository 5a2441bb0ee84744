#include "base/dense.h"

#include <gtest/gtest.h>

#include "base/random.h"

namespace orbifit {
namespace {

Eigen::MatrixXd random_matrix(Eigen::Index rows, Eigen::Index columns) {
  Random random(5);
  Eigen::MatrixXd result(rows, columns);
  for (double& value : result.reshaped()) value = random.uniform(-1, 1);
  return result;
}

TEST(Dense, BasisIsOrthonormalAndSpansTheColumns) {
  const Eigen::MatrixXd columns = random_matrix(6, 3);
  const Eigen::MatrixXd basis = orthonormal_basis(columns);
  ASSERT_EQ(basis.cols(), 3);
  EXPECT_LT((basis.transpose() * basis - Eigen::MatrixXd::Identity(3, 3)).norm(), 1e-14);
  EXPECT_LT((basis * (basis.transpose() * columns) - columns).norm(), 1e-14);
}

TEST(Dense, ShortestSolutionHasNoPartInTheKernel) {
  Eigen::MatrixXd matrix = random_matrix(5, 4);
  matrix.col(3) = matrix.col(0) - 2 * matrix.col(1);
  const Eigen::VectorXd kernel = Eigen::Vector4d(1, -2, 0, -1);
  ASSERT_LT((matrix * kernel).norm(), 1e-14);
  const Eigen::MatrixXd right = random_matrix(5, 2);
  const Eigen::MatrixXd found = shortest_solution(matrix, right, 1e-9);
  ASSERT_EQ(found.cols(), 2);
  EXPECT_LT((matrix.transpose() * (matrix * found - right)).norm(), 1e-13);  // least squares
  EXPECT_LT((kernel.transpose() * found).norm(), 1e-13);
}

TEST(Dense, SemidefiniteSystemsAreSolvedInBothSizes) {
  const Eigen::MatrixXd half = random_matrix(6, 6);
  const Matrix6d matrix = half.transpose() * half;
  const Vector6d right = random_matrix(6, 1);
  EXPECT_LT((matrix * solve_semidefinite(matrix, right) - right).norm(), 1e-12);
  const Eigen::MatrixXd same = matrix;
  const Eigen::VectorXd of_same = right;
  EXPECT_LT((matrix * solve_semidefinite(same, of_same) - right).norm(), 1e-12);
}

}  // namespace
}  // namespace orbifit

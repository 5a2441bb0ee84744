#include "solver/condition.h"

#include <Eigen/LU>
#include <Eigen/QR>
#include <gtest/gtest.h>

#include "base/dense.h"
#include "base/random.h"

namespace orbifit {
namespace {

class Condition : public testing::TestWithParam<double> {
 protected:
  // Symmetric, with eigenvalues of either sign from 1 down to 1 / GetParam(); the last ones zero.
  static Eigen::MatrixXd matrix_of_rank(Eigen::Index rank) {
    constexpr Eigen::Index kSize = 40;
    Random random(3);
    Eigen::MatrixXd entries(kSize, kSize);
    for (double& entry : entries.reshaped()) entry = random.normal();
    const Eigen::MatrixXd turned = Eigen::HouseholderQR<Eigen::MatrixXd>(entries).householderQ();
    Eigen::VectorXd values = Eigen::VectorXd::Zero(kSize);
    for (Eigen::Index i = 0; i < rank; ++i) {
      values[i] = std::pow(GetParam(), -double(i) / double(rank - 1)) * (i % 3 == 1 ? -1 : 1);
    }
    return turned * values.asDiagonal() * turned.transpose();
  }
};

TEST_P(Condition, IsThatOfTheSingularValues) {
  for (const Eigen::Index rank : {40, 33}) {
    const Eigen::MatrixXd matrix = matrix_of_rank(rank);
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Eigen::MatrixXd inverse = svd.matrixV().leftCols(rank) *
                                    svd.singularValues().head(rank).cwiseInverse().asDiagonal() *
                                    svd.matrixU().leftCols(rank).transpose();
    const double estimate = condition_estimate(
        matrix.cols(), [&](const Eigen::VectorXd& x) -> Eigen::VectorXd { return matrix * x; },
        [&](const Eigen::VectorXd& x) -> Eigen::VectorXd { return inverse * x; });
    const double exact = svd.singularValues()[0] / svd.singularValues()[rank - 1];
    EXPECT_NEAR(estimate / exact, 1, 0.03);
    EXPECT_LT(estimate, exact * (1 + 1e-6));
  }
}

INSTANTIATE_TEST_SUITE_P(Conditions, Condition, testing::Values(10.0, 1e4, 1e8));

}  // namespace
}  // namespace orbifit

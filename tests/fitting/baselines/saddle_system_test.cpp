#include "saddle_system.h"

#include <Eigen/QR>
#include <gtest/gtest.h>

#include "base/dense.h"
#include "base/random.h"

namespace orbifit {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// A positive definite matrix with a border, and constraints of which the last repeat the first ones.
struct SaddleCase {
  int constraints, repeated, border;
};

class Saddle : public testing::TestWithParam<SaddleCase> {
 protected:
  static constexpr Eigen::Index kSize = 30;

  Saddle() : border_(GetParam().border) {
    MatrixXd factor = random(kSize + border_, kSize + border_);
    matrix_ = factor * factor.transpose() + 0.1 * MatrixXd::Identity(factor.rows(), factor.cols());
    constraints_.resize(GetParam().constraints + GetParam().repeated, kSize);
    constraints_.topRows(GetParam().constraints) = random(GetParam().constraints, kSize);
    constraints_.bottomRows(GetParam().repeated) =
        random(GetParam().repeated, GetParam().constraints) * constraints_.topRows(GetParam().constraints);
    whole_ = MatrixXd::Zero(matrix_.rows() + constraints_.rows(), matrix_.rows() + constraints_.rows());
    whole_.topLeftCorner(matrix_.rows(), matrix_.cols()) = matrix_;
    whole_.block(matrix_.rows(), 0, constraints_.rows(), kSize) = constraints_;
    whole_.block(0, matrix_.rows(), kSize, constraints_.rows()) = constraints_.transpose();
  }

  MatrixXd random(Eigen::Index rows, Eigen::Index columns) {
    MatrixXd result(rows, columns);
    for (double& entry : result.reshaped()) entry = random_.normal();
    return result;
  }

  SaddleSystem factorised() const {
    SaddleSystem system(constraints_.sparseView());
    const Eigen::SparseMatrix<double> sparse = matrix_.topLeftCorner(kSize, kSize).sparseView();
    system.factorise(sparse.triangularView<Eigen::Lower>(), matrix_.topRightCorner(kSize, border_),
                     matrix_.bottomRightCorner(border_, border_));
    return system;
  }

  Random random_{5};
  Eigen::Index border_;
  MatrixXd matrix_, constraints_, whole_;
};

TEST_P(Saddle, SolutionIsThatOfTheWholeSystem) {
  const VectorXd right = random(matrix_.rows(), 1);
  VectorXd all = VectorXd::Zero(whole_.rows());
  all.head(right.size()) = right;
  const VectorXd expected = whole_.completeOrthogonalDecomposition().solve(all).head(right.size());
  const VectorXd found = factorised().solve(right);
  EXPECT_LT((found - expected).norm(), 1e-11 * expected.norm());
  EXPECT_LE((constraints_ * found.head(kSize)).norm(), 1e-13 * found.norm());
}

TEST_P(Saddle, ConditionIsThatOfTheWholeSystemOnItsRange) {
  const VectorXd values = Eigen::JacobiSVD<MatrixXd>(whole_).singularValues();
  const double exact = values[0] / values[whole_.rows() - 1 - GetParam().repeated];
  EXPECT_NEAR(factorised().condition() / exact, 1, 0.05);
}

INSTANTIATE_TEST_SUITE_P(Systems, Saddle,
                         testing::Values(SaddleCase{0, 0, 0}, SaddleCase{0, 0, 6}, SaddleCase{9, 0, 6},
                                         SaddleCase{9, 5, 0}, SaddleCase{20, 12, 6}));

}  // namespace
}  // namespace orbifit

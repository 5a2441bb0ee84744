#include "solver/normal_solver.h"

#include <gtest/gtest.h>

#include "base/random.h"
#include "solver/gram_sum.h"

namespace orbifit {
namespace {

// Normal equations of rows that each touch a few columns near one another, and of a few rows that touch all.
struct RandomNormal {
  RandomNormal(int size, int few_columns, double hold) : few(size, few_columns), side(size) {
    Random random(static_cast<std::uint64_t>(size));
    dense = hold * Eigen::MatrixXd::Identity(size, size);
    for (int row = 0; row < 3 * size; ++row) {
      GramPart& part = parts.emplace_back();
      const int first = static_cast<int>(random.uniform(0, size));
      Eigen::VectorXd entries(size);
      entries.setZero();
      for (int j = first; j < std::min(size, first + 4); ++j) {
        part.columns.push_back(j);
        entries[j] = random.normal();
      }
      const auto own = entries.segment(first, static_cast<Eigen::Index>(part.columns.size()));
      part.gram = own * own.transpose();
      part.side = random.normal() * own;
      dense += entries * entries.transpose();
    }
    for (double& entry : few.reshaped()) entry = random.normal();
    for (double& entry : side) entry = random.normal();
  }

  Eigen::SparseMatrix<double> lower(int threads, double hold) const {
    const Eigen::Index size = side.size();
    Eigen::SparseMatrix<double> result(Eigen::VectorXd::Constant(size, hold).asDiagonal());
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(size);
    RunContext context;
    context.threads = threads;
    add_parts(parts, context, result, sum);
    return result;
  }

  std::vector<GramPart> parts;
  Eigen::MatrixXd dense, few;
  Eigen::VectorXd side;
};

class NormalSolverOfSize : public testing::TestWithParam<int> {};

TEST_P(NormalSolverOfSize, SolvesAsADenseFactorisationDoes) {
  const RandomNormal normal(GetParam(), 5, 1e-3);
  NormalSolver solver;
  ASSERT_TRUE(solver.compute(normal.lower(1, 1e-3), normal.few));
  const Eigen::MatrixXd whole = normal.dense + normal.few * normal.few.transpose();
  const Eigen::VectorXd expected = whole.ldlt().solve(normal.side);
  EXPECT_LT((solver.solve(normal.side) - expected).norm(), 1e-10 * expected.norm());
  EXPECT_LT((solver.multiply(expected) - normal.side).norm(), 1e-10 * normal.side.norm());
}

TEST_P(NormalSolverOfSize, SumsAreTheSameWithAnyThreads) {
  const RandomNormal normal(GetParam(), 1, 1);
  const Eigen::SparseMatrix<double> one = normal.lower(1, 1);
  const Eigen::SparseMatrix<double> three = normal.lower(3, 1);
  EXPECT_EQ(one.nonZeros(), three.nonZeros());
  EXPECT_EQ(Eigen::MatrixXd(one), Eigen::MatrixXd(three));
  const Eigen::MatrixXd expected = normal.dense.triangularView<Eigen::Lower>();
  EXPECT_LT((Eigen::MatrixXd(one) - expected).norm(), 1e-12 * expected.norm());
}

INSTANTIATE_TEST_SUITE_P(Sizes, NormalSolverOfSize, testing::Values(1, 2, 7, 64, 65, 300));

// What A leaves open, up to a hold like the fit's, B determines.
TEST(NormalSolver, FindsWhatTheFewColumnsAloneDetermine) {
  constexpr int kSize = 120;
  constexpr double kHold = 1e-10;
  Eigen::SparseMatrix<double> chain(kSize, kSize);  // leaves a common shift open
  for (int i = 0; i < kSize; ++i) {
    chain.insert(i, i) = (i == 0 || i == kSize - 1 ? 1.0 : 2.0) + kHold;
    if (i + 1 < kSize) chain.insert(i + 1, i) = -1;
  }
  const Eigen::MatrixXd few = Eigen::MatrixXd::Constant(kSize, 1, 1e-3);
  NormalSolver solver;
  ASSERT_TRUE(solver.compute(chain, few));
  Random random(3);
  Eigen::VectorXd expected(kSize);
  for (double& entry : expected) entry = random.normal();
  const Eigen::VectorXd found = solver.solve(solver.multiply(expected));
  EXPECT_LT((found - expected).norm(), 1e-10 * expected.norm());
}

}  // namespace
}  // namespace orbifit

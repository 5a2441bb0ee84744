#include "deformation/symmetric_factor.h"

#include <vector>

#include <gtest/gtest.h>

#include "base/random.h"

namespace orbifit {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

// The square of a grid's Laplacian, as that of editing is, held a little: lower half.
Sparse grid_matrix(int side) {
  std::vector<Eigen::Triplet<double>> entries;
  const auto at = [&](int x, int y) { return side * x + y; };
  for (int x = 0; x < side; ++x) {
    for (int y = 0; y < side; ++y) {
      for (const auto& [u, v] : {std::pair{x + 1, y}, std::pair{x, y + 1}}) {
        if (u == side || v == side) continue;
        entries.emplace_back(at(x, y), at(x, y), 1);
        entries.emplace_back(at(u, v), at(u, v), 1);
        entries.emplace_back(at(x, y), at(u, v), -1);
        entries.emplace_back(at(u, v), at(x, y), -1);
      }
    }
  }
  Sparse laplacian(side * side, side * side);
  laplacian.setFromTriplets(entries.begin(), entries.end());
  Sparse identity(side * side, side * side);
  identity.setIdentity();
  const Sparse full = laplacian * laplacian + 1e-3 * identity;
  return full.triangularView<Eigen::Lower>();
}

Sparse full_matrix(int size) {
  Random random(3, "factor");
  Eigen::MatrixXd rows(size, size);
  for (double& entry : rows.reshaped()) entry = random.normal();
  const Eigen::MatrixXd gram = rows * rows.transpose() + Eigen::MatrixXd::Identity(size, size);
  return Sparse(Eigen::MatrixXd(gram.triangularView<Eigen::Lower>()).sparseView());
}

void expect_solved(const SymmetricFactor& factor, const Sparse& lower) {
  Eigen::VectorXd wanted(lower.rows());
  for (Eigen::Index i = 0; i < wanted.size(); ++i) wanted[i] = static_cast<double>(i % 7) - 3;
  const Eigen::VectorXd right = lower.selfadjointView<Eigen::Lower>() * wanted;
  Eigen::VectorXd found = right;
  factor.solve(found);
  EXPECT_LT((lower.selfadjointView<Eigen::Lower>() * found - right).norm(), 1e-11 * right.norm());
}

TEST(SymmetricFactor, SolvesAndIsSparseWhereMostOfItStaysZero) {
  SymmetricFactor factor;
  const Sparse grid = grid_matrix(40);
  ASSERT_TRUE(factor.factorise(grid));
  EXPECT_TRUE(factor.is_sparse());
  expect_solved(factor, grid);
  const Sparse full = full_matrix(60);
  ASSERT_TRUE(factor.factorise(full));
  EXPECT_FALSE(factor.is_sparse());
  expect_solved(factor, full);
}

TEST(SymmetricFactor, RefusesWhatIsNotPositiveDefinite) {
  SymmetricFactor factor;
  Sparse grid = grid_matrix(40);
  grid.coeffRef(800, 800) = -5;
  EXPECT_FALSE(factor.factorise(grid));
  Sparse full = full_matrix(60);
  full.coeffRef(30, 30) = -5;
  EXPECT_FALSE(factor.factorise(full));
}

TEST(SymmetricFactor, NothingHasAFactor) {
  SymmetricFactor factor;
  ASSERT_TRUE(factor.factorise(Sparse(0, 0)));
  Eigen::VectorXd none(0);
  factor.solve(none);
}

}  // namespace
}  // namespace orbifit

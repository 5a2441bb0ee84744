#include <cmath>

#include <gtest/gtest.h>

#include "base/random.h"
#include "basis/gram.h"
#include "deformation/neighbour_sums.h"
#include "deformation/precise_sum.h"

namespace orbifit {
namespace {

// (1 + x)(1 - x) - 1 = -x^2, of which doubles keep nothing.
TEST(PreciseSum, KeepsWhatCancels) {
  const double x = std::ldexp(1.0, -40);
  PreciseSum sum(-1);
  sum.add_product(1 + x, 1 - x);
  EXPECT_EQ(sum.value(), -x * x);
  PreciseSum twice;
  twice.add_product(3, sum);
  EXPECT_EQ(twice.value(), -3 * x * x);
}

TEST(Gram, IsTheProductOfTheRows) {
  Random random(3, "rows");
  for (const Eigen::Index columns : {4, 8, 12, 16, 20, 44}) {
    for (const Eigen::Index count : {0, 1, 7, 48}) {
      const RowMajorMatrix rows = RowMajorMatrix::NullaryExpr(count, columns, [&] { return random.normal(); });
      Eigen::MatrixXd found;
      lower_gram(rows, found);
      const Eigen::MatrixXd due = rows.transpose() * rows;
      ASSERT_EQ(found.rows(), columns);
      EXPECT_LT(Eigen::MatrixXd((found - due).triangularView<Eigen::Lower>()).norm(), 1e-12 * (1 + due.norm()))
          << columns << " columns, " << count << " rows";
    }
  }
}

TEST(Gram, FillsUpToFours) {
  EXPECT_EQ(whole_fours(0), 0);
  EXPECT_EQ(whole_fours(1), 4);
  EXPECT_EQ(whole_fours(4), 4);
  EXPECT_EQ(whole_fours(5), 8);
}

// Against the same sums, edge by edge.
TEST(NeighbourSums, AreSumsOverNeighbours) {
  Random random(4, "samples");
  Points samples(60, 3);
  for (double& entry : samples.reshaped()) entry = random.uniform(0, 1);
  samples.row(59) << 9, 9, 9;  // has no neighbours
  const Corotation energy = corotation(samples, 0.35);
  const NeighbourSums sums(energy);
  Points displacements(60, 3);
  for (double& entry : displacements.reshaped()) entry = 0.2 * random.normal();
  std::vector<Eigen::Matrix3d> rotations;
  for (int i = 0; i < 60; ++i) rotations.push_back(random.rotation());
  const FourRows rows = in_fours(displacements);
  const FourMatrices matrices = in_fours(rotations);
  for (int i = 0; i < 60; ++i) {
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    Eigen::Vector3d turned = Eigen::Vector3d::Zero();
    double residual = 0;
    double size = 0;
    for (const int j : energy.neighbours[static_cast<std::size_t>(i)]) {
      const Eigen::Vector3d edge = (samples.row(i) - samples.row(j)).transpose();
      const Eigen::Vector3d now = edge + (displacements.row(i) - displacements.row(j)).transpose();
      const Eigen::Vector3d mean =
          0.5 * (rotations[static_cast<std::size_t>(i)] + rotations[static_cast<std::size_t>(j)]) * edge;
      covariance += now * edge.transpose();
      turned += mean - edge;
      residual += (now - mean).squaredNorm();
      size += edge.squaredNorm();
    }
    EXPECT_LT((sums.covariance(i, rows) - covariance).norm(), 1e-13);
    EXPECT_LT((sums.turned(i, matrices) - turned).norm(), 1e-13);
    EXPECT_NEAR(sums.squared_residual(i, matrices, rows), residual, 1e-13);
    EXPECT_NEAR(sums.size(i), size, 1e-13);
  }
}

TEST(NeighbourSums, TurnAsTheCorotationDoes) {
  Random random(5, "samples");
  Points samples(40, 3);
  for (double& entry : samples.reshaped()) entry = random.uniform(0, 1);
  const Corotation energy = corotation(samples, 0.4);
  const NeighbourSums sums(energy);
  const Points moved = 0.1 * Points::NullaryExpr(40, 3, [&] { return random.normal(); });
  std::vector<Eigen::Matrix3d> rotations(40, Eigen::Matrix3d::Identity());
  const std::vector<Eigen::Matrix3d> due = local_rotations(energy, samples + moved, rotations);
  std::vector<Eigen::Matrix3d> covariances;
  std::vector<double> sizes;
  for (int i = 0; i < 40; ++i) {
    covariances.push_back(sums.covariance(i, in_fours(moved)));
    sizes.push_back(sums.size(i));
  }
  turn_locally(covariances, sizes, rotations);
  for (std::size_t i = 0; i < 40; ++i) EXPECT_LT((rotations[i] - due[i]).norm(), 1e-10);
}

}  // namespace
}  // namespace orbifit

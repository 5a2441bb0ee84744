#include "solver/rigid_modes.h"

#include <gtest/gtest.h>

#include "orbifit/model/motion.h"

#include "base/random.h"

namespace orbifit {
namespace {

Eigen::VectorXd as_column(const Points& rows) {
  return Eigen::Map<const Eigen::VectorXd>(rows.data(), rows.size());
}

Points random_points(Random& random) {
  Points points(40, 3);
  for (auto point : points.rowwise()) point << random.uniform(), random.uniform(), 100 + random.uniform();
  return points;
}

TEST(RigidModes, SpanTheSmallMotions) {
  Random random(1);
  const Points points = random_points(random);
  const Eigen::MatrixXd modes = rigid_modes(points);
  ASSERT_EQ(modes.cols(), 6);
  EXPECT_LT((modes.transpose() * modes - Eigen::MatrixXd::Identity(6, 6)).norm(), 1e-12);
  const Eigen::Vector3d turn = random.direction();
  Points moved(points.rows(), 3);
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    moved.row(i) = (turn.cross(points.row(i).transpose()) + Eigen::Vector3d(1, -2, 3)).transpose();
  }
  const Eigen::VectorXd motion = as_column(moved);
  EXPECT_LT((motion - modes * (modes.transpose() * motion)).norm(), 1e-12 * motion.norm());
  const Points inwards = points.rowwise() - points.colwise().mean();
  EXPECT_LT((modes.transpose() * as_column(inwards)).norm(), 1e-10);
}

TEST(RigidModes, TurnsThatMoveNothingAreNone) {
  Points line(3, 3);
  line << 0, 0, 0, 1, 2, 3, 2, 4, 6;
  EXPECT_EQ(rigid_modes(line).cols(), 5);
  EXPECT_EQ(rigid_modes(line.topRows(1)).cols(), 3);
}

}  // namespace
}  // namespace orbifit

#include "batch/same_shapes.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "batch/shape_invariants.h"
#include "cube.h"

namespace orbifit::batch {
namespace {

Mesh moved(Mesh mesh, const Eigen::Matrix3d& linear, double scale) {
  mesh.vertices = ((scale * mesh.vertices * linear.transpose()).rowwise() + Eigen::RowVector3d(3, -1, 7)).eval();
  return mesh;
}

const Eigen::Matrix3d kRotation = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();

Mesh wedge() {
  Mesh mesh;
  mesh.vertices.resize(4, 3);
  mesh.vertices << 0, 0, 0, 3, 0, 0, 0, 2, 0, 0.2, 0.3, 1;
  mesh.faces.resize(4, 3);
  mesh.faces << 0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2;
  return mesh;
}

TEST(ShapeInvariants, DependOnTheShapeAlone) {
  const auto one = shape_invariants(cube_mesh(2)), finer = shape_invariants(cube_mesh(5));
  const auto turned = shape_invariants(moved(cube_mesh(2), kRotation, 4));
  for (std::size_t k = 0; k < one.values.size(); ++k) {
    EXPECT_NEAR(finer.values[k], one.values[k], 1e-12);
    EXPECT_NEAR(turned.values[k], one.values[k], 1e-12);
  }
  EXPECT_NEAR(turned.size, 4 * one.size, 1e-12);
  EXPECT_NEAR(one.values[0], 1.0 / 3, 1e-12);
  // Of a unit cube's surface the mean of r^2 is 1/4 + 2/12.
  EXPECT_NEAR(one.size * one.size, 5.0 / 12, 1e-12);
}

TEST(SameShapes, AreFoundUpToASimilarityAndAnotherMesh) {
  EXPECT_TRUE(same_up_to_similarity(wedge(), moved(wedge(), kRotation, 0.3), 1e-6));
  EXPECT_TRUE(same_up_to_similarity(wedge(), moved(wedge(), -kRotation, 5), 1e-6));
  // The principal axes of a cube are any.
  EXPECT_TRUE(same_up_to_similarity(cube_mesh(2), moved(cube_mesh(3), kRotation, 2), 1e-6));
}

TEST(SameShapes, OthersAreNot) {
  Mesh other = wedge();
  other.vertices(3, 2) = 1.1;
  EXPECT_FALSE(same_up_to_similarity(wedge(), other, 1e-3));
  Mesh stretched = cube_mesh(3);
  stretched.vertices.col(0) *= 1.05;
  EXPECT_FALSE(same_up_to_similarity(cube_mesh(3), stretched, 1e-3));
}

}  // namespace
}  // namespace orbifit::batch

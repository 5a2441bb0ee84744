#include "orbifit/apps/upright.h"

#include <numeric>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "orbifit/model/mesh.h"

namespace orbifit {
namespace {

// A box between two corners, appended.
void add_box(Mesh& mesh, const Eigen::RowVector3d& low, const Eigen::RowVector3d& high) {
  const auto first = static_cast<int>(mesh.vertices.rows());
  const auto face = mesh.faces.rows();
  mesh.vertices.conservativeResize(first + 8, 3);
  for (int i = 0; i < 8; ++i) {
    for (int k = 0; k < 3; ++k) mesh.vertices(first + i, k) = (i >> k & 1) == 0 ? low[k] : high[k];
  }
  const Eigen::Matrix<int, 12, 3> faces{{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                        {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  mesh.faces.conservativeResize(face + 12, 3);
  mesh.faces.bottomRows(12) = faces.array() + first;
}

// A stool on four legs, up along z.
Mesh stool() {
  Mesh mesh;
  add_box(mesh, {-0.5, -0.5, 0.9}, {0.5, 0.5, 1});
  for (const double x : {-0.45, 0.35}) {
    for (const double y : {-0.45, 0.35}) add_box(mesh, {x, y, 0}, {x + 0.1, y + 0.1, 0.9});
  }
  return mesh;
}

Mesh turned(Mesh mesh) {  // z to y
  const Points old = mesh.vertices;
  mesh.vertices.col(0) = old.col(1);
  mesh.vertices.col(1) = old.col(2);
  mesh.vertices.col(2) = old.col(0);
  return mesh;
}

TEST(Upright, StandsAStoolOnItsLegs) {
  EXPECT_EQ(guess_up(stool()), Eigen::Vector3d::UnitZ());
  EXPECT_EQ(guess_up(turned(stool())), Eigen::Vector3d::UnitY());
}

// An L, extruded along z: it stands flat there though it would stand on y too.
TEST(Upright, LeavesABlockAsItIs) {
  Mesh mesh;
  add_box(mesh, {0, 0, 0}, {1, 0.3, 0.5});
  add_box(mesh, {0, 0.3, 0}, {0.3, 1, 0.5});
  EXPECT_EQ(guess_up(mesh), Eigen::Vector3d::UnitZ());
}

TEST(Upright, TakesWhatIsSaidBeforeWhatItGuesses) {
  const Mesh mesh = stool();
  EXPECT_EQ(up_of(mesh, "stool.obj"), Eigen::Vector3d::UnitZ());
  EXPECT_EQ(up_of(mesh, "stool.GLB"), Eigen::Vector3d::UnitY());  // as glTF prescribes
  SymmetryAnnotation annotation = empty_annotation(mesh, 0.005);
  annotation.up = -Eigen::Vector3d::UnitX();
  EXPECT_EQ(up_of(mesh, "stool.glb", &annotation), *annotation.up);
}

TEST(Upright, FollowsAnAxisOfTheWholeThatIsOblique) {
  Mesh mesh = stool();
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.6, Eigen::Vector3d(1, 2, 0).normalized()).toRotationMatrix();
  mesh.vertices = (mesh.vertices * turn.transpose()).eval();
  std::vector<int> all(static_cast<std::size_t>(mesh.faces.rows()));
  std::iota(all.begin(), all.end(), 0);
  SymmetryAnnotation annotation = empty_annotation(mesh, 0.005);
  GroupFrame frame = turn;
  frame.col(1) *= -1;
  frame.col(2) *= -1;  // the axis points down
  annotation.regions.push_back(make_region(*PointGroup::parse("C4v"), Eigen::Vector3d::Zero(), frame, all, "whole"));
  EXPECT_LT((up_of(mesh, "stool.obj", &annotation) - turn.col(2)).norm(), 1e-12);
  annotation.regions.front().faces.pop_back();  // of a part it says nothing
  EXPECT_GT((up_of(mesh, "stool.obj", &annotation) - turn.col(2)).norm(), 0.1);
}

TEST(Upright, OfNothingIsZ) {
  EXPECT_EQ(guess_up(Mesh{}), Eigen::Vector3d::UnitZ());
  Mesh flat;
  flat.vertices = Points::Zero(3, 3);
  flat.faces.resize(1, 3);
  flat.faces << 0, 1, 2;
  EXPECT_EQ(guess_up(flat), Eigen::Vector3d::UnitZ());
}

}  // namespace
}  // namespace orbifit

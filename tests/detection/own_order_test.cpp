#include "own_order.h"

#include <algorithm>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "orbifit/model/random.h"

#include "shapes.h"

namespace orbifit {
namespace {

Mesh bumpy() {
  Mesh mesh = test::hills(20, 0.01);
  Random random(4);
  for (double& x : mesh.vertices.reshaped()) x += 0.001 * random.normal();
  return mesh;
}

std::vector<int> shuffled(Eigen::Index count, Random& random) {
  std::vector<int> order(static_cast<std::size_t>(count));
  std::iota(order.begin(), order.end(), 0);
  for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
  return order;
}

Mesh in_other_order(const Mesh& mesh, Random& random) {
  const std::vector<int> place = shuffled(mesh.vertices.rows(), random);
  Mesh result = mesh;
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
    result.vertices.row(place[static_cast<std::size_t>(v)]) = mesh.vertices.row(v);
  }
  const std::vector<int> faces = shuffled(mesh.faces.rows(), random);
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    const auto first = static_cast<Eigen::Index>(random.below(3));
    for (Eigen::Index k = 0; k < 3; ++k) {
      const int vertex = mesh.faces(faces[static_cast<std::size_t>(f)], (first + k) % 3);
      result.faces(f, k) = place[static_cast<std::size_t>(vertex)];
    }
  }
  return result;
}

const std::vector<Mesh>& meshes() {
  static const std::vector<Mesh> all{test::box(1, 2, 3), test::prism(7, 1, 2), test::ball(12, 1), test::hills(12, 0),
                                     bumpy()};
  return all;
}

TEST(OwnOrder, IsTheSameWhateverTheFiles) {
  Random random(1);
  for (const Mesh& mesh : meshes()) {
    const OwnOrder expected = in_own_order(mesh);
    for (int trial = 0; trial < 5; ++trial) {
      const OwnOrder found = in_own_order(in_other_order(mesh, random));
      EXPECT_EQ(found.mesh.vertices, expected.mesh.vertices);
      EXPECT_EQ(found.mesh.faces, expected.mesh.faces);
    }
  }
}

TEST(OwnOrder, TellsWhichFaceEachWas) {
  for (const Mesh& mesh : meshes()) {
    const OwnOrder ordered = in_own_order(mesh);
    std::vector<int> once = ordered.face;
    std::ranges::sort(once);
    EXPECT_EQ(once, test::all_faces(mesh));
    const Points middles = face_centroids(mesh);
    const Points found = face_centroids(ordered.mesh);
    const Points normals = face_normals(mesh);
    const Points facing = face_normals(ordered.mesh);
    for (std::size_t f = 0; f < ordered.face.size(); ++f) {
      const auto row = static_cast<Eigen::Index>(f);
      EXPECT_LT((found.row(row) - middles.row(ordered.face[f])).norm(), 1e-12);
      EXPECT_LT((facing.row(row) - normals.row(ordered.face[f])).norm(), 1e-9) << "corners go round the same way";
    }
  }
}

TEST(OwnOrder, TurnsWithAShapeThatLeavesNoChoice) {
  Random random(2);
  const Mesh mesh = bumpy();
  const OwnOrder expected = in_own_order(mesh);
  for (int trial = 0; trial < 5; ++trial) {
    const Motion motion{random.rotation(), 3 * random.direction()};
    EXPECT_EQ(in_own_order(test::moved(mesh, motion)).face, expected.face);
  }
}

TEST(OwnOrder, StaysWhereNothingCanBeCompared) {
  Mesh heap = test::box(1, 1, 1);
  heap.vertices.setZero();
  EXPECT_EQ(in_own_order(heap).face, test::all_faces(heap));
  Mesh huge = test::box(1e308, 1e308, 1e308);
  std::vector<int> once = in_own_order(huge).face;
  std::ranges::sort(once);
  EXPECT_EQ(once, test::all_faces(huge));
  EXPECT_TRUE(in_own_order(Mesh{}).face.empty());
}

}  // namespace
}  // namespace orbifit

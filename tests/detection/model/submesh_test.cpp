#include <algorithm>
#include <numeric>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "orbifit/model/mesh.h"

#include "base/random.h"

namespace orbifit {
namespace {

constexpr int kVertices = 3000;

// Few faces of a mesh are looked up another way than many.
class Submesh : public testing::TestWithParam<int> {
 protected:
  Submesh() {
    Random random(5, "submesh");
    mesh_.vertices.resize(kVertices, 3);
    for (double& coordinate : mesh_.vertices.reshaped()) coordinate = random.normal();
    mesh_.faces.resize(2 * kVertices, 3);
    for (int& vertex : mesh_.faces.reshaped()) vertex = static_cast<int>(random.below(kVertices));
    faces_.resize(static_cast<std::size_t>(mesh_.faces.rows()));
    std::iota(faces_.begin(), faces_.end(), 0);
    for (std::size_t i = faces_.size(); i > 1; --i) std::swap(faces_[i - 1], faces_[random.below(i)]);
    faces_.resize(static_cast<std::size_t>(GetParam()));
  }

  Mesh mesh_;
  std::vector<int> faces_;
};

TEST_P(Submesh, HasTheVerticesThatItsFacesUse) {
  std::set<int> used;
  for (const int face : faces_) {
    for (const int vertex : mesh_.faces.row(face)) used.insert(vertex);
  }
  EXPECT_EQ(vertices_of_faces(mesh_, faces_), std::vector<int>(used.begin(), used.end()));
}

TEST_P(Submesh, HasTheSameFaces) {
  std::vector<int> vertex_of;
  const Mesh part = submesh(mesh_, faces_, &vertex_of);
  EXPECT_EQ(vertex_of, vertices_of_faces(mesh_, faces_));
  ASSERT_EQ(part.faces.rows(), GetParam());
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const int vertex = part.faces(static_cast<Eigen::Index>(f), k);
      EXPECT_EQ(vertex_of[static_cast<std::size_t>(vertex)], mesh_.faces(faces_[f], k));
    }
  }
  EXPECT_EQ(part.vertices, Points(mesh_.vertices(vertex_of, Eigen::all)));
}

INSTANTIATE_TEST_SUITE_P(Faces, Submesh, testing::Values(0, 1, 20, 40, 1000, 2 * kVertices));

}  // namespace
}  // namespace orbifit

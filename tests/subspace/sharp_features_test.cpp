#include "sampling/sharp_features.h"

#include <cmath>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/model/errors.h"

#include "geometry/surface_index.h"

namespace orbifit {
namespace {

// A unit cube of two triangles a side.
Mesh cube() {
  Mesh mesh;
  mesh.vertices.resize(8, 3);
  mesh.vertices << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1;
  mesh.faces.resize(12, 3);
  mesh.faces << 0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4, 1, 2, 6, 1, 6, 5, 2, 3, 7, 2, 7, 6, 3, 0, 4, 3, 4,
      7;
  return mesh;
}

// Every triangle with vertices of its own, and once more the other way round.
Mesh doubled_soup(const Mesh& mesh) {
  Mesh soup;
  const Eigen::Index faces = mesh.faces.rows();
  soup.vertices.resize(6 * faces, 3);
  soup.faces.resize(2 * faces, 3);
  for (Eigen::Index f = 0; f < 2 * faces; ++f) {
    for (int k = 0; k < 3; ++k) {
      soup.vertices.row(3 * f + k) = mesh.vertices.row(mesh.faces(f % faces, f < faces ? k : 2 - k));
      soup.faces(f, k) = static_cast<int>(3 * f + k);
    }
  }
  return soup;
}

int count_near(const Points& points, const Eigen::RowVector3d& place) {
  return static_cast<int>(((points.rowwise() - place).rowwise().norm().array() < 1e-12).count());
}

class SharpFeaturesOfCube : public testing::TestWithParam<bool> {
 protected:
  Mesh mesh_ = GetParam() ? doubled_soup(cube()) : cube();
};

TEST_P(SharpFeaturesOfCube, AreItsCornersThenItsEdges) {
  const SurfaceSamples samples = sharp_feature_samples(mesh_, {0.26, 40});
  ASSERT_EQ(samples.points.rows(), 8 + 12 * 3);
  for (Eigen::Index c = 0; c < 8; ++c) {
    EXPECT_EQ(samples.points.row(c).cwiseAbs(), samples.points.row(c).array().round().matrix());
  }
  for (int axis = 0; axis < 3; ++axis) {
    for (int step = 0; step <= 4; ++step) {
      for (int end = 0; end < 4; ++end) {
        Eigen::RowVector3d place;
        place[axis] = step / 4.0;
        place[(axis + 1) % 3] = end / 2;
        place[(axis + 2) % 3] = end % 2;
        EXPECT_EQ(count_near(samples.points, place), 1) << place;
      }
    }
  }
}

TEST_P(SharpFeaturesOfCube, AreNoneForAWiderAngle) {
  EXPECT_EQ(sharp_feature_samples(mesh_, {0.26, 95}).points.rows(), 0);
}

INSTANTIATE_TEST_SUITE_P(Meshes, SharpFeaturesOfCube, testing::Bool(),
                         [](const auto& mesh) { return mesh.param ? "DoubledSoup" : "Plain"; });

TEST(SharpFeatures, CountBorders) {
  Mesh square = cube();
  square.faces = Triangles(square.faces.topRows(2));
  const SurfaceSamples samples = sharp_feature_samples(square, {0.5, 40});
  EXPECT_EQ(samples.points.rows(), 8);  // four corners and four middles; not the diagonal
}

// A round border has no corners; its points go round evenly.
TEST(SharpFeatures, SpreadOverLoopsWithoutCorners) {
  const int n = 48;
  Mesh disc;
  disc.vertices.resize(n + 1, 3);
  disc.faces.resize(n, 3);
  disc.vertices.row(n).setZero();
  for (int k = 0; k < n; ++k) {
    disc.vertices.row(k) << std::cos(2 * std::numbers::pi * k / n), std::sin(2 * std::numbers::pi * k / n), 0;
    disc.faces.row(k) << k, (k + 1) % n, n;
  }
  const SurfaceSamples samples = sharp_feature_samples(disc, {0.785, 40});
  ASSERT_EQ(samples.points.rows(), 8);
  for (Eigen::Index i = 0; i < 8; ++i) {
    const Eigen::RowVector3d next = samples.points.row((i + 1) % 8);
    EXPECT_NEAR((samples.points.row(i) - next).norm(), 2 * std::sin(std::numbers::pi / 8), 1e-9);
  }
}

class SharpFeaturesOfModel : public testing::TestWithParam<std::string> {};

TEST_P(SharpFeaturesOfModel, LieOnTheirFaces) {
  const Mesh mesh = generate(GetParam()).mesh;
  const double size = diagonal(mesh.vertices);
  const SurfaceSamples samples = sharp_feature_samples(mesh, {0.03 * size, 40});
  ASSERT_GT(samples.points.rows(), 0);
  ASSERT_EQ(samples.faces.size(), static_cast<std::size_t>(samples.points.rows()));
  const Points normals = face_normals(mesh);
  for (Eigen::Index i = 0; i < samples.points.rows(); ++i) {
    const int face = samples.faces[static_cast<std::size_t>(i)];
    const Eigen::Vector3d a = mesh.vertices.row(mesh.faces(face, 0));
    const Eigen::Vector3d b = mesh.vertices.row(mesh.faces(face, 1));
    const Eigen::Vector3d c = mesh.vertices.row(mesh.faces(face, 2));
    const Eigen::Vector3d share = nearest_on_triangle(samples.points.row(i).transpose(), a, b, c);
    const Eigen::Vector3d nearest = share[0] * a + share[1] * b + share[2] * c;
    EXPECT_LT((nearest - samples.points.row(i).transpose()).norm(), 1e-6 * size);
    EXPECT_EQ(samples.normals.row(i), normals.row(face));
  }
}

// Corners are where they are whatever the spacing, and more points come with a smaller one.
TEST_P(SharpFeaturesOfModel, GrowWithADecreasingSpacing) {
  const Mesh mesh = generate(GetParam()).mesh;
  const double size = diagonal(mesh.vertices);
  const Points coarse = sharp_feature_samples(mesh, {0.1 * size, 40}).points;
  const Points fine = sharp_feature_samples(mesh, {0.02 * size, 40}).points;
  EXPECT_GT(fine.rows(), coarse.rows());
}

INSTANTIATE_TEST_SUITE_P(Models, SharpFeaturesOfModel, testing::Values("bar", "table", "fan", "wheel"),
                         [](const auto& model) { return model.param; });

TEST(SharpFeatures, OptionsAreValidated) {
  EXPECT_THROW(sharp_feature_samples(cube(), {0, 40}), UsageError);
  EXPECT_THROW(sharp_feature_samples(cube(), {1, 180}), UsageError);
}

}  // namespace
}  // namespace orbifit

#include "geometry/sampling.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "orbifit/model/errors.h"

#include "geometry/surface_index.h"

namespace orbifit {
namespace {

// Faces whose areas span three orders of magnitude, one of them without area.
Mesh fan_of_faces() {
  Mesh mesh;
  mesh.vertices.resize(12, 3);
  mesh.faces.resize(10, 3);
  mesh.vertices.row(0).setZero();
  for (int v = 1; v < 12; ++v) {
    const double angle = 0.02 * v * v;
    const double reach = 1 + 0.2 * v;
    mesh.vertices.row(v) << reach * std::cos(angle), reach * std::sin(angle), 0.1 * v;
  }
  mesh.vertices.row(5) = mesh.vertices.row(4);
  for (int f = 0; f < 10; ++f) mesh.faces.row(f) << 0, f + 1, f + 2;
  return mesh;
}

TEST(SampleSurface, CountsAreProportionalToArea) {
  const Mesh mesh = fan_of_faces();
  Random random(2);
  const int count = 5000;
  const SurfaceSamples samples = sample_surface(mesh, count, random);
  const Eigen::VectorXd areas = face_areas(mesh);
  ASSERT_EQ(areas[3], 0);
  std::vector<int> counts(10, 0);
  for (const int face : samples.faces) ++counts[static_cast<std::size_t>(face)];
  // Stratified: a face of k equal parts gets k samples, give or take one at either end.
  for (int f = 0; f < 10; ++f) {
    EXPECT_NEAR(counts[static_cast<std::size_t>(f)], count * areas[f] / areas.sum(), 2) << "face " << f;
  }
  EXPECT_EQ(counts[3], 0);
}

TEST(SampleSurface, PointsAreUniformWithinAFace) {
  Mesh mesh;
  mesh.vertices.resize(3, 3);
  mesh.vertices << 0, 0, 0, 3, 0, 0, 0, 2, 0;
  mesh.faces.resize(1, 3);
  mesh.faces << 0, 1, 2;
  Random random(3);
  const int count = 40000;
  const SurfaceSamples samples = sample_surface(mesh, count, random);
  // Uniform: barycentric coordinates have mean 1/3 and second moments 1/6, 1/12.
  const Eigen::ArrayXd x = samples.points.col(0).array() / 3;
  const Eigen::ArrayXd y = samples.points.col(1).array() / 2;
  const double five_sigma = 5 * 0.3 / std::sqrt(count);
  EXPECT_NEAR(x.mean(), 1.0 / 3, five_sigma);
  EXPECT_NEAR(y.mean(), 1.0 / 3, five_sigma);
  EXPECT_NEAR((x * x).mean(), 1.0 / 6, five_sigma);
  EXPECT_NEAR((y * y).mean(), 1.0 / 6, five_sigma);
  EXPECT_NEAR((x * y).mean(), 1.0 / 12, five_sigma);
}

TEST(SampleSurface, PointsLieOnTheirFacesWithTheirNormals) {
  const Mesh mesh = fan_of_faces();
  const Points normals = face_normals(mesh);
  Random random(4);
  const SurfaceSamples samples = sample_surface(mesh, 1000, random);
  ASSERT_EQ(samples.points.rows(), 1000);
  ASSERT_EQ(samples.normals.rows(), 1000);
  for (int i = 0; i < 1000; ++i) {
    const int face = samples.faces[static_cast<std::size_t>(i)];
    EXPECT_LE(SurfaceIndex(mesh, {face}).nearest(samples.points.row(i)).distance, 1e-14);
    EXPECT_EQ(samples.normals.row(i), normals.row(face));
  }
}

TEST(SampleSurface, TheSameSeedGivesTheSamePoints) {
  const Mesh mesh = fan_of_faces();
  Random first(5), again(5), other(6);
  const SurfaceSamples samples = sample_surface(mesh, 100, first);
  EXPECT_EQ(samples.points, sample_surface(mesh, 100, again).points);
  EXPECT_NE(samples.points, sample_surface(mesh, 100, other).points);
}

TEST(SampleSurface, StaysOnTheGivenFaces) {
  Random random(7);
  const SurfaceSamples samples = sample_surface(fan_of_faces(), 200, random, {2, 3, 9});
  EXPECT_EQ(std::count(samples.faces.begin(), samples.faces.end(), 2) +
                std::count(samples.faces.begin(), samples.faces.end(), 9),
            200);
  EXPECT_GT(std::count(samples.faces.begin(), samples.faces.end(), 2), 0);
}

TEST(SampleSurface, RefusesASurfaceWithoutArea) {
  Random random(8);
  EXPECT_THROW(sample_surface(fan_of_faces(), 10, random, {3}), InputError);
  EXPECT_THROW(sample_surface(Mesh{}, 10, random), InputError);
}

TEST(SampleSurface, OfNoCountIsEmpty) {
  Random random(9);
  EXPECT_EQ(sample_surface(fan_of_faces(), 0, random).points.rows(), 0);
}

}  // namespace
}  // namespace orbifit

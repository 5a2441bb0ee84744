#include "symmetry/moving_surface.h"

#include <algorithm>
#include <limits>

#include <gtest/gtest.h>

#include "orbifit/datasets_tools/generate.h"

#include "base/random.h"
#include "geometry/surface_index.h"

namespace orbifit {
namespace {

using Eigen::Vector3d;

// A chair bent at random, so that its boxes no longer are what its order in space was made for.
class Moved : public testing::Test {
 protected:
  Moved() : mesh_(generate("chair").mesh), surface_(mesh_), size_(diagonal(mesh_.vertices)) {
    for (auto vertex : mesh_.vertices.rowwise()) vertex += (0.05 * size_ * random_.direction()).transpose();
    surface_.move(mesh_, RunContext{});
  }

  Vector3d somewhere(double reach) {
    const auto row = static_cast<Eigen::Index>(random_.below(static_cast<std::uint64_t>(mesh_.vertices.rows())));
    return mesh_.vertices.row(row).transpose() + reach * size_ * random_.uniform(0, 1) * random_.direction();
  }

  Random random_{5};
  Mesh mesh_;
  MovingSurface surface_;
  double size_;
};

TEST_F(Moved, AnswersAsAnIndexOfItsOwn) {
  const SurfaceIndex index(mesh_);
  int near = 0;
  int facing = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vector3d point = somewhere(i % 2 == 0 ? 0.02 : 0.5);
    const double most = i % 3 == 0 ? std::numeric_limits<double>::infinity() : 0.1 * size_;
    const auto expected = index.nearest(point, most);
    const auto found = surface_.nearest(point, most);
    ASSERT_EQ(found.face < 0, expected.face < 0);
    const double distance = surface_.nearest(point).distance;
    for (const double within : {distance, distance * (1 - 1e-9), 2 * distance}) {
      EXPECT_EQ(surface_.within(point, within, found.place), surface_.nearest(point, within).face >= 0);
    }
    if (found.face >= 0) {
      ++near;
      EXPECT_NEAR(found.distance, expected.distance, 1e-13 * size_);
      EXPECT_NEAR((found.point - point).norm(), found.distance, 1e-13 * size_);
      const Vector3d there = mesh_.vertices(mesh_.faces.row(found.face), Eigen::all).transpose() * found.barycentric;
      EXPECT_LT((there - found.point).norm(), 1e-13 * size_);
    }
    const Vector3d normal = random_.direction();
    const auto expected_facing = index.nearest_facing(point, normal, 0.6, most, i % 2 == 0);
    const auto found_facing = surface_.nearest_facing(point, normal, 0.6, most, i % 2 == 0);
    ASSERT_EQ(found_facing.face < 0, expected_facing.face < 0);
    if (found_facing.face < 0) continue;
    ++facing;
    EXPECT_NEAR(found_facing.distance, expected_facing.distance, 1e-13 * size_);
    const double cosine = surface_.normal(found_facing.face).dot(normal);
    EXPECT_GE(i % 2 == 0 ? std::abs(cosine) : cosine, 0.6 - 1e-12);
    for (const int likely : {found_facing.place, 0, static_cast<int>(mesh_.faces.rows()), -1}) {
      EXPECT_EQ(surface_.nearest_facing(point, normal, 0.6, most, i % 2 == 0, likely).face, found_facing.face);
    }
  }
  EXPECT_GT(near, 1500);
  EXPECT_GT(facing, 1000);
}

TEST_F(Moved, MeetsRaysWhereAnIndexDoes) {
  const SurfaceIndex index(mesh_);
  int met = 0;
  int missed = 0;
  int apart = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vector3d origin = somewhere(0.5);
    const Vector3d direction = i % 5 == 0 ? Vector3d::Unit(i % 3) * (i % 2 == 0 ? 1 : -2) : random_.direction();
    const double least = 0.01 * size_;
    const auto expected = index.cast(origin, direction, least);
    const int face = surface_.first_hit(origin, direction, least);
    face < 0 ? ++missed : ++met;
    apart += face != (expected ? expected->face : -1) ? 1 : 0;
    if (!expected || face != expected->face) continue;
    EXPECT_FALSE(surface_.occluded(origin, direction, least, expected->distance - 1e-6 * size_));
    EXPECT_TRUE(surface_.occluded(origin, direction, least, expected->distance + 1e-6 * size_));
  }
  EXPECT_GT(met, 500);
  EXPECT_GT(missed, 500);
  EXPECT_LE(apart, 3);  // the index sees rays in single precision
}

TEST_F(Moved, OfSomeFacesKnowsThoseAlone) {
  std::vector<int> some;
  for (int face = 3; face < mesh_.faces.rows(); face += 7) some.push_back(face);
  const MovingSurface part(mesh_, some);
  const SurfaceIndex index(mesh_, some);
  for (int i = 0; i < 500; ++i) {
    const Vector3d point = somewhere(0.3);
    const auto found = part.nearest(point);
    EXPECT_NEAR(found.distance, index.nearest(point).distance, 1e-13 * size_);
    EXPECT_TRUE(std::ranges::binary_search(some, found.face));
  }
}

TEST_F(Moved, OfFacesAtOneDistanceGivesTheLowestNumber) {
  for (Eigen::Index v = 0; v < mesh_.vertices.rows(); v += 5) {
    int lowest = -1;
    for (Eigen::Index face = 0; face < mesh_.faces.rows() && lowest < 0; ++face) {
      if ((mesh_.vertices(mesh_.faces.row(face), Eigen::all).rowwise() - mesh_.vertices.row(v))
              .rowwise()
              .norm()
              .minCoeff() == 0)
        lowest = static_cast<int>(face);
    }
    EXPECT_EQ(surface_.nearest(mesh_.vertices.row(v).transpose()).face, lowest);
  }
}

TEST_F(Moved, AnswersFromFarAway) {
  const Vector3d far = Vector3d(3, -2, 1) * 1e8 * size_;
  double least = std::numeric_limits<double>::infinity();
  for (Eigen::Index v = 0; v < mesh_.vertices.rows(); ++v) {
    least = std::min(least, (mesh_.vertices.row(v).transpose() - far).norm());
  }
  EXPECT_NEAR(surface_.nearest(far).distance, least, 1e-13 * least);
  EXPECT_EQ(surface_.nearest(far, size_).face, -1);
}

TEST(MovingSurface, WithoutFacesHasNothing) {
  Mesh none;
  none.vertices.resize(0, 3);
  none.faces.resize(0, 3);
  const MovingSurface surface(none);
  EXPECT_EQ(surface.nearest(Vector3d::Zero()).face, -1);
  EXPECT_EQ(surface.first_hit(Vector3d::Zero(), Vector3d::UnitX(), 0), -1);
  EXPECT_FALSE(surface.occluded(Vector3d::Zero(), Vector3d::UnitX(), 0, 1));
}

}  // namespace
}  // namespace orbifit

// What the grid holds and what it cannot hold, against exact distances.

#include "surface/surface_grid.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "base/random.h"
#include "geometry/sampling.h"
#include "geometry/surface_index.h"
#include "shapes.h"

namespace orbifit {
namespace {

using Eigen::Vector3d;

Vector3d direction(Random& random) {
  return Vector3d(random.normal(), random.normal(), random.normal()).normalized();
}

double degrees_between_lines(const Vector3d& a, const Vector3d& b) {
  return 180 / std::numbers::pi * std::atan2(a.cross(b).norm(), std::abs(a.dot(b)));
}

struct Case {
  std::string name;
  Mesh mesh;
  double reach;
};

class GridOf : public testing::TestWithParam<Case> {
 protected:
  GridOf()
      : prepared_(prepare(GetParam().mesh)),
        faces_(test::all_faces(prepared_.mesh)),
        grid_(prepared_, faces_, GetParam().reach) {}

  PreparedMesh prepared_;
  std::vector<int> faces_;
  SurfaceGrid grid_;
};

TEST_P(GridOf, HoldsWhatIsNear) {
  Random random(3, "near");
  const SurfaceSamples samples = sample_surface(prepared_.mesh, 2000, random);
  for (Eigen::Index i = 0; i < samples.points.rows(); ++i) {
    const Vector3d normal = samples.normals.row(i);
    const Vector3d place = Vector3d(samples.points.row(i)) + 0.2 * GetParam().reach * direction(random);
    const Vector3d across = normal.cross(direction(random)).normalized();
    const double angle = 15 * std::numbers::pi / 180;
    EXPECT_TRUE(grid_.holds(place, axis_rotation(across, angle) * normal));
    EXPECT_TRUE(grid_.holds(place, -normal));
  }
}

TEST_P(GridOf, DoesNotHoldWhatIsFar) {
  Random random(4, "far");
  std::vector<std::unique_ptr<SurfaceIndex>> of_face;
  for (const int face : faces_) of_face.push_back(std::make_unique<SurfaceIndex>(prepared_.mesh, std::vector{face}));
  int far = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vector3d place = 0.6 * Vector3d(random.uniform() - 0.5, random.uniform() - 0.5, random.uniform() - 0.5);
    const Vector3d normal = direction(random);
    const bool allowed = std::ranges::any_of(faces_, [&](int face) {
      return degrees_between_lines(prepared_.normals.row(face), normal) <= 50 &&
             of_face[static_cast<std::size_t>(face)]->nearest(place).distance <= 1.75 * GetParam().reach;
    });
    if (allowed) continue;
    ++far;
    EXPECT_FALSE(grid_.holds(place, normal)) << place.transpose() << ", " << normal.transpose();
  }
  EXPECT_GT(far, 10000);
}

TEST_P(GridOf, CoversWhatItHoldsWithSomeNormal) {
  Random random(5, "covered");
  const SurfaceSamples samples = sample_surface(prepared_.mesh, 500, random);
  int only_covered = 0;
  for (Eigen::Index i = 0; i < samples.points.rows(); ++i) {
    const Vector3d place =
        Vector3d(samples.points.row(i)) + 3 * GetParam().reach * random.uniform() * direction(random);
    bool held = false;
    for (Eigen::Index f = 0; f < prepared_.normals.rows(); ++f)
      held = held || grid_.holds(place, prepared_.normals.row(f));
    EXPECT_EQ(grid_.covers(place), held) << place.transpose();
    const Vector3d across = Vector3d(samples.normals.row(i)).unitOrthogonal();
    if (grid_.covers(samples.points.row(i)) && !grid_.holds(samples.points.row(i), across)) ++only_covered;
  }
  EXPECT_GT(only_covered, 200);
}

TEST_P(GridOf, HoldsNothingOutsideTheBox) {
  for (const double far : {1.0, 1e3, 1e9, 1e300, -1e9}) EXPECT_FALSE(grid_.holds({far, 0, 0}, Vector3d::UnitX()));
  EXPECT_FALSE(grid_.holds({std::nan(""), 0, 0}, Vector3d::UnitX()));
  EXPECT_FALSE(grid_.covers({std::nan(""), 0, 0}));
  EXPECT_FALSE(grid_.covers({1e9, 0, 0}));
}

INSTANTIATE_TEST_SUITE_P(Meshes, GridOf,
                         testing::Values(Case{"box", test::box(1, 2, 3), 0.005},
                                         Case{"coarse", test::box(1, 1, 1), 0.03},
                                         Case{"prism", test::prism(7, 1, 2), 0.01},
                                         Case{"scalene", test::scalene(), 0.005}),
                         [](const testing::TestParamInfo<Case>& of) { return of.param.name; });

}  // namespace
}  // namespace orbifit

#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "orbifit/detection/detect_points.h"
#include "orbifit/model/errors.h"

#include "base/random.h"
#include "geometry/sampling.h"
#include "shapes.h"

namespace orbifit {
namespace {

using Eigen::Vector3d;

// What a profile of points (radius, height) sweeps about z, in 96 steps.
Mesh turned(const std::vector<Eigen::Vector2d>& profile) {
  constexpr int kSteps = 96;
  const int rings = static_cast<int>(profile.size());
  Mesh mesh;
  mesh.vertices.resize(rings * kSteps, 3);
  mesh.faces.resize(2 * (rings - 1) * kSteps, 3);
  int face = 0;
  for (int k = 0; k < rings; ++k) {
    for (int i = 0; i < kSteps; ++i) {
      const double angle = 2 * std::numbers::pi * i / kSteps;
      const Eigen::Vector2d& at = profile[static_cast<std::size_t>(k)];
      mesh.vertices.row(k * kSteps + i) << at.x() * std::cos(angle), at.x() * std::sin(angle), at.y();
      if (k + 1 == rings) continue;
      const int a = k * kSteps + i;
      const int b = k * kSteps + (i + 1) % kSteps;
      mesh.faces.row(face++) << a, b, b + kSteps;
      mesh.faces.row(face++) << a, b + kSteps, a + kSteps;
    }
  }
  return mesh;
}

Mesh round_bar() {
  return turned({{0, -0.7}, {0.5, -0.7}, {0.5, 0.7}, {0, 0.7}});
}
Mesh round_tip() {
  return turned({{0, -0.5}, {0.5, -0.5}, {0, 0.8}});
}

const Motion kPose{axis_rotation(Vector3d(1, 2, 3).normalized(), 0.8), Vector3d(3, -2, 5)};

struct View {
  int count = 6000;
  double noise = 0;
  Vector3d towards = Vector3d::Zero();  // zero: seen from all sides
};

// Samples in a pose of their own; of a view those whose faces look at it.
PointCloud scan_of(const Mesh& mesh, const View& view = {}) {
  Random random(7, "scan");
  const SurfaceSamples samples = sample_surface(mesh, view.count, random);
  std::vector<Vector3d> seen;
  for (Eigen::Index i = 0; i < samples.points.rows(); ++i) {
    const double facing = view.towards.dot(Vector3d(samples.normals.row(i)));
    if (view.towards.norm() > 0 && facing <= 0.1) continue;
    const Vector3d error = view.noise * Vector3d(random.normal(), random.normal(), random.normal());
    seen.push_back(kPose(Vector3d(samples.points.row(i)) + error));
  }
  PointCloud scan;
  scan.points.resize(static_cast<Eigen::Index>(seen.size()), 3);
  for (std::size_t i = 0; i < seen.size(); ++i) scan.points.row(static_cast<Eigen::Index>(i)) = seen[i];
  return scan;
}

SymmetryAnnotation detected(const PointCloud& scan, int threads = 1) {
  RunContext context;
  context.threads = threads;
  return detect_points(scan, {}, context);
}

std::string groups(const SymmetryAnnotation& found) {
  std::string text;
  for (const Region& region : found.regions) text += (text.empty() ? "" : " ") + region.group.symbol();
  return text;
}

void expect_axis_along_z(const Region& region, double degrees) {
  const Vector3d z = kPose.linear.col(2);
  EXPECT_LT(region.axis.cross(z).norm(), std::sin(degrees * std::numbers::pi / 180));
  const Vector3d from = region.centre - kPose.translation;
  EXPECT_LT((from - z * z.dot(from)).norm(), 0.03);
}

struct Whole {
  const char* name;
  Mesh mesh;
  double noise;
  const char* group;
};

class WholeScan : public testing::TestWithParam<Whole> {};

TEST_P(WholeScan, HasTheGroupOfItsShape) {
  const PointCloud scan = scan_of(GetParam().mesh, {6000, GetParam().noise, Vector3d::Zero()});
  const SymmetryAnnotation found = detected(scan);
  ASSERT_EQ(groups(found), GetParam().group);
  EXPECT_EQ(found.mesh_vertices, 6000);
  EXPECT_EQ(found.mesh_faces, 6000);
  EXPECT_GE(found.tolerance, 2 * GetParam().noise / found.mesh_diagonal);
  if (found.regions.empty()) return;
  EXPECT_GT(found.regions[0].faces.size(), 5700U);
  EXPECT_LT(found.regions[0].faces.back(), 6000);
  if (found.regions[0].group.continuous()) expect_axis_along_z(found.regions[0], 1);
}

INSTANTIATE_TEST_SUITE_P(Shapes, WholeScan,
                         testing::Values(Whole{"box", test::box(1, 0.7, 0.45), 0, "D2h"},
                                         Whole{"cylinder", round_bar(), 0, "Dinfh"},
                                         Whole{"cone", round_tip(), 0, "Cinfv"},
                                         Whole{"noisy_cylinder", round_bar(), 0.006, "Dinfh"},
                                         Whole{"scalene", test::scalene(), 0, ""}),
                         [](const auto& instance) { return std::string(instance.param.name); });

class HalfSeen : public testing::TestWithParam<double> {};

TEST_P(HalfSeen, CylinderTurns) {
  const PointCloud scan = scan_of(round_bar(), {8000, GetParam(), Vector3d(1, 0.3, 0.5).normalized()});
  const SymmetryAnnotation found = detected(scan);
  ASSERT_EQ(groups(found), "Cinfv");
  EXPECT_GT(static_cast<double>(found.regions[0].faces.size()), 0.85 * static_cast<double>(scan.points.rows()));
  expect_axis_along_z(found.regions[0], 2);
}

INSTANTIATE_TEST_SUITE_P(Noise, HalfSeen, testing::Values(0.0, 0.004),
                         [](const auto& instance) { return instance.param > 0 ? "noisy" : "exact"; });

TEST(PointDetection, BoxSeenFromItsCornerDoesNotTurn) {
  const SymmetryAnnotation found =
      detected(scan_of(test::box(1, 0.7, 0.45), {8000, 0.002, Vector3d(1, 0.8, 1.2).normalized()}));
  for (const Region& region : found.regions) EXPECT_FALSE(region.group.continuous()) << region.group.symbol();
}

TEST(PointDetection, OutliersAreInNoRegion) {
  PointCloud scan = scan_of(round_bar());
  const Eigen::Index first = scan.points.rows();
  scan.points.conservativeResize(first + 3, 3);
  for (int k = 0; k < 3; ++k) {
    scan.points.row(first + k) = kPose(Vector3d(0.9 + 0.2 * k, 0.3 * k, 0.2 - 0.4 * k)).transpose();
  }
  const SymmetryAnnotation found = detected(scan);
  ASSERT_FALSE(found.regions.empty());
  for (const Region& region : found.regions) EXPECT_LT(region.faces.back(), first);
}

TEST(PointDetection, IsTheSameOnTwoThreads) {
  const PointCloud scan = scan_of(round_bar(), {4000, 0.002, Vector3d(1, 0.3, 0.5).normalized()});
  const SymmetryAnnotation one = detected(scan, 1);
  const SymmetryAnnotation two = detected(scan, 2);
  ASSERT_EQ(groups(one), groups(two));
  ASSERT_FALSE(one.regions.empty());
  EXPECT_EQ(one.regions[0].axis, two.regions[0].axis);
  EXPECT_EQ(one.regions[0].centre, two.regions[0].centre);
  EXPECT_EQ(one.regions[0].faces, two.regions[0].faces);
}

TEST(PointDetection, RefusesWhatHasNoSurface) {
  PointCloud scan = scan_of(round_bar());
  PointCloud few;
  few.points = scan.points.topRows(49);
  EXPECT_THROW(detected(few), InputError);
  PointCloud same;
  same.points = Points::Constant(500, 3, 0.25);
  EXPECT_THROW(detected(same), InputError);
  PointCloud two_places = same;
  two_places.points.topRows(250).setZero();
  EXPECT_THROW(detected(two_places), InputError);
  scan.points(17, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(detected(scan), InputError);
}

}  // namespace
}  // namespace orbifit

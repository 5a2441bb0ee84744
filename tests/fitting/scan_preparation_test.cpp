#include "scan/scan_preparation.h"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/datasets_tools/virtual_scan.h"
#include "orbifit/model/errors.h"

#include "base/random.h"
#include "geometry/surface_index.h"
#include "scan/thinned_scan.h"

namespace orbifit {
namespace {

PointCloud sphere_scan(int count, const Eigen::Vector3d& centre) {
  Random random(3);
  PointCloud scan;
  scan.points.resize(count, 3);
  for (int i = 0; i < count; ++i) scan.points.row(i) = (centre + random.direction()).transpose();
  return scan;
}

class PreparedSphere : public testing::TestWithParam<double> {};

TEST_P(PreparedSphere, HasTheSpheresNormalsHoweverFarItLies) {
  const Eigen::Vector3d centre = GetParam() * Eigen::Vector3d(1, -2, 0.5);
  PointCloud scan = sphere_scan(4000, centre);
  const PreparedScan prepared = prepare_scan(scan, {}, RunContext{});
  ASSERT_EQ(prepared.normals.rows(), prepared.points.rows());
  EXPECT_FALSE(prepared.normals_oriented);
  for (Eigen::Index i = 0; i < prepared.points.rows(); ++i) {
    const Eigen::Vector3d radial = (prepared.points.row(i).transpose() - centre).normalized();
    EXPECT_GT(std::abs(radial.dot(prepared.normals.row(i).transpose())), 0.97);
  }
}

INSTANTIATE_TEST_SUITE_P(Offsets, PreparedSphere, testing::Values(0.0, 1e4));

TEST(ScanPreparation, TellsTheNoiseOfAScan) {
  for (const double noise : {0.0, 0.002, 0.01}) {
    Random random(6);
    PointCloud scan = sphere_scan(20000, {0, 0, 0});
    for (Eigen::Index i = 0; i < scan.points.rows(); ++i) scan.points.row(i) *= 1 + noise * random.normal();
    EXPECT_NEAR(prepare_scan(scan, {}, RunContext{}).noise, noise, 0.2 * noise + 1e-3);  // curved by 1e-3 at that size
  }
}

TEST(ScanPreparation, TurnsNormalsTowardsTheViewpoint) {
  PointCloud scan = sphere_scan(1000, {0, 0, 0});
  scan.viewpoints.resize(1, 3);
  scan.viewpoints << 0, 0, 9;
  const PreparedScan prepared = prepare_scan(scan, {}, RunContext{});
  EXPECT_TRUE(prepared.normals_oriented);
  for (Eigen::Index i = 0; i < prepared.points.rows(); ++i) {
    EXPECT_GE(prepared.normals.row(i).dot(scan.viewpoints.row(0) - prepared.points.row(i)), 0);
  }
}

TEST(ScanPreparation, KeepsNearlyAsManyPointsAsAllowedAndSpreadsThem) {
  ScanPreparationOptions options;
  options.most_points = 500;
  const PreparedScan prepared = prepare_scan(sphere_scan(20000, {0, 0, 0}), options, RunContext{});
  EXPECT_LE(prepared.points.rows(), 500);
  EXPECT_GT(prepared.points.rows(), 400);
  EXPECT_GT(prepared.spacing, 0.03);
}

// A point's number stands in all its places.
PointCloud numbered_scan(int count) {
  PointCloud scan = sphere_scan(count, {0, 0, 0});
  scan.points.col(0) = Eigen::VectorXd::LinSpaced(count, 0, count - 1);
  scan.normals = scan.points;
  scan.viewpoints = scan.points;
  scan.dropped = 7;
  return scan;
}

TEST(ThinnedScan, DrawsPointsFromEverywhereInTheirOrderWithAllThatTheyHave) {
  constexpr int kCount = 50000, kMost = 2000, kParts = 20;
  const PointCloud scan = numbered_scan(kCount);
  const PointCloud few = thinned(scan, kMost, 5);
  ASSERT_EQ(few.points.rows(), kMost);
  EXPECT_EQ(few.normals, few.points);
  EXPECT_EQ(few.viewpoints, few.points);
  EXPECT_EQ(few.dropped, 7);
  std::vector<int> drawn(kParts, 0);
  for (Eigen::Index i = 0; i < few.points.rows(); ++i) {
    EXPECT_TRUE(i == 0 || few.points(i - 1, 0) < few.points(i, 0));
    const auto number = static_cast<Eigen::Index>(few.points(i, 0));
    EXPECT_EQ(few.points.row(i), scan.points.row(number));
    ++drawn[static_cast<std::size_t>(number * kParts / kCount)];
  }
  for (const int part : drawn) EXPECT_NEAR(part, kMost / kParts, 5 * std::sqrt(kMost / kParts));
  EXPECT_EQ(thinned(scan, kMost, 5).points, few.points);
  EXPECT_NE(thinned(scan, kMost, 6).points, few.points);
}

TEST(ThinnedScan, KeepsAllPointsThatAreNotTooManyAndAViewpointForAll) {
  PointCloud scan = numbered_scan(300);
  EXPECT_EQ(thinned(scan, 300, 1).points, scan.points);
  scan.viewpoints = Points::Ones(1, 3);
  EXPECT_EQ(thinned(scan, 299, 1).viewpoints, scan.viewpoints);
}

TEST(ScanPreparation, SeesTheSameSurfaceHoweverManyPointsAScanHas) {
  const PreparedScan prepared = prepare_scan(sphere_scan(3 * kScanPointsRead, {0, 0, 0}), {}, RunContext{});
  for (Eigen::Index i = 0; i < prepared.points.rows(); ++i) {
    EXPECT_GT(std::abs(prepared.points.row(i).dot(prepared.normals.row(i))), 0.999);
  }
}

// Points of a virtual scan that are farther than `far` from its mesh, a fraction of the diagonal.
int far_from(const Mesh& mesh, const Points& points, double far) {
  const SurfaceIndex surface(mesh);
  const double size = diagonal(mesh.vertices);
  int count = 0;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    count += surface.within(points.row(i).transpose(), far * size) ? 0 : 1;
  }
  return count;
}

class Scanned : public testing::TestWithParam<const char*> {};

TEST_P(Scanned, LosesItsStraysAndLittleElse) {
  constexpr double kFar = 0.03;
  RunContext context;
  const Mesh mesh = generate(GetParam()).mesh;
  ScanOptions options;
  options.noise = 0.002;
  const PointCloud clean = virtual_scan(mesh, options, context);
  ScanPreparationOptions all;
  all.most_points = static_cast<int>(clean.points.rows());
  EXPECT_GT(prepare_scan(clean, all, context).points.rows(), 0.99 * static_cast<double>(clean.points.rows()));
  options.outliers = 0.05;
  const PointCloud spoilt = virtual_scan(mesh, options, context);
  const Points left = prepare_scan(spoilt, all, context).points;
  const int before = far_from(mesh, spoilt.points, kFar);
  ASSERT_GT(before, 50);
  EXPECT_LT(far_from(mesh, left, kFar), 0.3 * before);
  EXPECT_GT(left.rows(), 0.94 * static_cast<double>(spoilt.points.rows()));
}

INSTANTIATE_TEST_SUITE_P(Models, Scanned, testing::Values("car", "chair", "desk_fan", "plane"),
                         [](const auto& each) { return std::string(each.param); });

// A floor that is seen far more sparsely than what stands on it is no less a surface.
TEST(ScanPreparation, KeepsSparseSurfaces) {
  Random random(8);
  PointCloud scan = sphere_scan(6000, {0, 0, 1});
  const Eigen::Index dense = scan.points.rows();
  scan.points.conservativeResize(dense + 400, 3);
  for (Eigen::Index i = dense; i < scan.points.rows(); ++i) {
    scan.points.row(i) << random.uniform(-4, 4), random.uniform(-4, 4), -3;
  }
  ScanPreparationOptions all;
  all.most_points = static_cast<int>(scan.points.rows());
  EXPECT_GT(prepare_scan(scan, all, RunContext{}).points.rows(), dense + 390);
}

TEST(ScanPreparation, RefusesTooFewPointsAndPointsAtOnePlace) {
  EXPECT_THROW(prepare_scan(sphere_scan(9, {0, 0, 0}), {}, RunContext{}), InputError);
  PointCloud one;
  one.points = Points::Ones(50, 3);
  EXPECT_THROW(prepare_scan(one, {}, RunContext{}), InputError);
}

}  // namespace
}  // namespace orbifit

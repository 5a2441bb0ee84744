#include "orbifit/datasets_tools/virtual_scan.h"

#include <cmath>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/model/errors.h"

#include "geometry/surface_index.h"

namespace orbifit {
namespace {

using Eigen::Vector3d;

PointCloud scan(const Mesh& mesh, const ScanOptions& options, std::uint64_t seed = 1, int threads = 1) {
  RunContext context;
  context.seed = seed;
  context.threads = threads;
  return virtual_scan(mesh, options, context);
}

class ScanOfModel : public testing::TestWithParam<std::string> {
 protected:
  Mesh mesh_ = generate(GetParam()).mesh;
  double size_ = diagonal(mesh_.vertices);
};

TEST_P(ScanOfModel, PointsLieOnTheSurfaceInSightOfTheirViewpoint) {
  ScanOptions options;
  options.views = 3;
  options.width = 120;
  options.height = 90;
  const PointCloud cloud = scan(mesh_, options);
  ASSERT_GT(cloud.points.rows(), 300);
  ASSERT_EQ(cloud.viewpoints.rows(), cloud.points.rows());
  const SurfaceIndex surface(mesh_);
  for (Eigen::Index i = 0; i < cloud.points.rows(); ++i) {
    const Vector3d point = cloud.points.row(i);
    EXPECT_LT(surface.nearest(point).distance, 1e-6 * size_);
    const Vector3d back = cloud.viewpoints.row(i).transpose() - point;
    EXPECT_FALSE(surface.occluded(point, back.normalized(), 1e-4 * size_, back.norm()));
  }
}

TEST_P(ScanOfModel, OneViewSeesNoBackSide) {
  ScanOptions options;
  options.grazing_limit = 70;
  const PointCloud cloud = scan(mesh_, options);
  const SurfaceIndex surface(mesh_);
  const Points normals = face_normals(mesh_);
  int steep = 0;
  for (Eigen::Index i = 0; i < cloud.points.rows(); ++i) {
    const Vector3d point = cloud.points.row(i);
    const Vector3d back = (cloud.viewpoints.row(i).transpose() - point).normalized();
    const double cosine = normals.row(surface.nearest(point).face).dot(back);
    if (cosine < std::cos(70 * std::numbers::pi / 180) - 1e-6)
      ++steep;  // at an edge the nearest face may be the next one
  }
  EXPECT_LT(steep, 0.01 * static_cast<double>(cloud.points.rows()));
}

INSTANTIATE_TEST_SUITE_P(Models, ScanOfModel, testing::Values("chair", "table", "fan"));

class VirtualScan : public testing::Test {
 protected:
  Mesh mesh_ = generate("table", {{"detail", 1}}).mesh;
  double size_ = diagonal(mesh_.vertices);
};

TEST_F(VirtualScan, ViewsStandAroundTheShape) {
  ScanOptions options;
  options.views = 4;
  options.azimuth = 10;
  options.elevation = 30;
  options.distance = 3;
  const PointCloud cloud = scan(mesh_, options);
  std::set<long> quarters;
  for (Eigen::Index i = 0; i < cloud.points.rows(); ++i) {
    const Vector3d from = cloud.viewpoints.row(i).transpose() - bounding_box_centre(mesh_.vertices);
    EXPECT_NEAR(from.norm(), 3 * size_, 1e-12);
    EXPECT_NEAR(from.z(), 1.5 * size_, 1e-12);
    const double turns = (std::atan2(from.y(), from.x()) * 180 / std::numbers::pi - 10) / 90;
    EXPECT_NEAR(turns, std::round(turns), 1e-9);
    quarters.insert((std::lround(turns) + 8) % 4);
  }
  EXPECT_EQ(quarters.size(), 4U);
}

TEST_F(VirtualScan, UpMayBeAnyAxis) {
  ScanOptions options;
  options.elevation = 89;
  for (const Vector3d& up : {Vector3d(0, 0, 1), Vector3d(1, 0, 0), Vector3d(0, -2, 0)}) {
    options.up = up;
    const PointCloud cloud = scan(mesh_, options);
    const Vector3d from = cloud.viewpoints.row(0).transpose() - bounding_box_centre(mesh_.vertices);
    EXPECT_GT(from.normalized().dot(up.normalized()), 0.999);
  }
}

TEST_F(VirtualScan, NoiseLiesAlongTheRayAndGrowsWithTheSquareOfTheDepth) {
  // A plate edge-on to nothing: seen from above at 1 and at 2 diagonals it is at nearly the centre's depth.
  ScanOptions options;
  options.elevation = 89.9;
  options.noise = 0.01;
  const PointCloud noisy = scan(mesh_, options);
  options.noise = 0;
  const PointCloud clean = scan(mesh_, options);
  ASSERT_EQ(noisy.points.rows(), clean.points.rows());
  double sum = 0;
  for (Eigen::Index i = 0; i < clean.points.rows(); ++i) {
    const Vector3d camera = clean.viewpoints.row(i);
    const Vector3d ray = clean.points.row(i).transpose() - camera;
    const Vector3d error = (noisy.points.row(i) - clean.points.row(i)).transpose();
    EXPECT_LT(error.cross(ray.normalized()).norm(), 1e-12);
    const double depth = ray.dot((bounding_box_centre(mesh_.vertices) - camera).normalized());
    const double deviation = 0.01 * size_ * std::pow(depth / (2 * size_), 2);
    sum += error.squaredNorm() / (deviation * deviation);
  }
  const double count = static_cast<double>(clean.points.rows());
  EXPECT_NEAR(sum / count, 1, 5 * std::sqrt(2 / count));
}

TEST_F(VirtualScan, OutliersAreAsManyAsAsked) {
  ScanOptions options;
  const PointCloud clean = scan(mesh_, options);
  options.outliers = 0.2;
  const PointCloud dirty = scan(mesh_, options);
  ASSERT_EQ(dirty.points.rows(), clean.points.rows());
  const Eigen::Index moved = ((dirty.points - clean.points).rowwise().norm().array() > 0).count();
  EXPECT_EQ(moved, std::lround(0.2 * static_cast<double>(clean.points.rows())));
  const Eigen::RowVector3d low = mesh_.vertices.colwise().minCoeff();
  const Eigen::RowVector3d high = mesh_.vertices.colwise().maxCoeff();
  EXPECT_TRUE(((dirty.points.rowwise() - low).array() >= -1e-9).all());
  EXPECT_TRUE(((dirty.points.rowwise() - high).array() <= 1e-9).all());
}

TEST_F(VirtualScan, DependsOnTheSeedAndNotOnTheThreads) {
  ScanOptions options;
  options.views = 2;
  options.noise = 0.005;
  options.outliers = 0.1;
  const PointCloud one = scan(mesh_, options, 7, 1);
  const PointCloud two = scan(mesh_, options, 7, 2);
  const PointCloud other = scan(mesh_, options, 8, 1);
  EXPECT_EQ(one.points, two.points);
  EXPECT_EQ(one.viewpoints, two.viewpoints);
  ASSERT_EQ(one.points.rows(), other.points.rows());
  EXPECT_GT((one.points - other.points).norm(), 0);
}

TEST_F(VirtualScan, GrazingPixelsAreLost) {
  ScanOptions options;
  options.elevation = 10;
  options.grazing_limit = 90;
  const Eigen::Index all = scan(mesh_, options).points.rows();
  options.grazing_limit = 75;  // the table's top is seen at 80 degrees from its normal
  EXPECT_LT(scan(mesh_, options).points.rows(), 0.9 * static_cast<double>(all));
}

TEST_F(VirtualScan, SaysWhenNothingIsSeen) {
  ScanOptions options;
  options.grazing_limit = 1e-6;
  EXPECT_THROW(scan(mesh_, options), NoResultError);
  EXPECT_THROW(scan(Mesh{}, ScanOptions{}), NoResultError);
}

TEST_F(VirtualScan, RefusesOptionsByName) {
  const auto message = [](auto change) {
    ScanOptions options;
    change(options);
    try {
      options.validate();
    } catch (const UsageError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  EXPECT_EQ(message([](ScanOptions&) {}), "accepted");
  EXPECT_EQ(message([](ScanOptions& o) { o.views = 0; }), "views = 0: must be at least 1");
  EXPECT_EQ(message([](ScanOptions& o) { o.elevation = 90; }), "elevation = 90: must be between -90 and 90 degrees");
  EXPECT_EQ(message([](ScanOptions& o) { o.distance = 0.6; }), "distance = 0.6: must be above 0.6 diagonals");
  EXPECT_EQ(message([](ScanOptions& o) { o.noise = -1; }), "noise = -1: must be at least 0");
  EXPECT_EQ(message([](ScanOptions& o) { o.outliers = 1; }), "outliers = 1: must be at least 0 and below 1");
  EXPECT_EQ(message([](ScanOptions& o) { o.grazing_limit = 0; }),
            "grazing_limit = 0: must be above 0 and at most 90 degrees");
  EXPECT_EQ(message([](ScanOptions& o) { o.up.setZero(); }), "up = 0: must be a vector of positive length");
}

}  // namespace
}  // namespace orbifit

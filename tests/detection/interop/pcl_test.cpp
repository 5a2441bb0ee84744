#include "orbifit/interop/pcl.h"

#include <limits>

#include <gtest/gtest.h>

namespace orbifit {
namespace {

// Numbers that single precision holds exactly.
PointCloud scan() {
  PointCloud result;
  result.points.resize(3, 3);
  result.points << 0.5, -1.25, 2, 3, 0, 0.125, -4, 8, 16;
  result.normals.resize(3, 3);
  result.normals << 0, 0, 1, 0, -1, 0, 1, 0, 0;
  result.viewpoints.resize(1, 3);
  result.viewpoints << 10, 20, -30;
  return result;
}

TEST(Pcl, KeepsPointsNormalsAndTheViewpoint) {
  const pcl::PointCloud<pcl::PointNormal> cloud = to_pcl<pcl::PointNormal>(scan());
  ASSERT_EQ(cloud.size(), 3U);
  EXPECT_EQ(cloud.width, 3U);
  EXPECT_EQ(cloud.height, 1U);
  EXPECT_EQ(cloud[1].z, 0.125F);
  EXPECT_EQ(cloud[1].normal_y, -1.0F);
  EXPECT_EQ(cloud.sensor_origin_, Eigen::Vector4f(10, 20, -30, 0));
  const PointCloud back = from_pcl(cloud);
  EXPECT_EQ(back.points, scan().points);
  EXPECT_EQ(back.normals, scan().normals);
  EXPECT_EQ(back.viewpoints, scan().viewpoints);
  EXPECT_EQ(back.dropped, 0);
}

TEST(Pcl, PointXYZHasNoNormals) {
  const pcl::PointCloud<pcl::PointXYZ> cloud = to_pcl<pcl::PointXYZ>(scan());
  const PointCloud back = from_pcl(cloud);
  EXPECT_EQ(back.points, scan().points);
  EXPECT_EQ(back.normals.rows(), 0);
  EXPECT_EQ(back.viewpoints, scan().viewpoints);
}

TEST(Pcl, WhatIsUnknownStaysUnknown) {
  PointCloud bare = scan();
  bare.normals.resize(0, 3);
  bare.viewpoints.resize(0, 3);
  const pcl::PointCloud<pcl::PointNormal> cloud = to_pcl<pcl::PointNormal>(bare);
  EXPECT_TRUE(std::isnan(cloud[0].normal_x));
  const PointCloud back = from_pcl(cloud);
  EXPECT_EQ(back.normals.rows(), 0);
  EXPECT_EQ(back.viewpoints.rows(), 0);
  EXPECT_EQ(from_pcl(to_pcl<pcl::PointWithViewpoint>(bare)).viewpoints.rows(), 0);
}

TEST(Pcl, PointsThatAreNotFiniteAreLeftOutAndCounted) {
  pcl::PointCloud<pcl::PointNormal> cloud = to_pcl<pcl::PointNormal>(scan());
  cloud[1].y = std::numeric_limits<float>::quiet_NaN();
  const PointCloud back = from_pcl(cloud);
  EXPECT_EQ(back.dropped, 1);
  ASSERT_EQ(back.points.rows(), 2);
  EXPECT_EQ(back.points.row(1), scan().points.row(2));
  EXPECT_EQ(back.normals.row(1), scan().normals.row(2));
}

TEST(Pcl, NormalsAreMadeUnitAndKnownForAllPointsOrNone) {
  pcl::PointCloud<pcl::PointNormal> cloud = to_pcl<pcl::PointNormal>(scan());
  cloud[0].normal_z = 4;
  EXPECT_EQ(from_pcl(cloud).normals, scan().normals);
  cloud[0].normal_z = 0;
  EXPECT_EQ(from_pcl(cloud).normals.rows(), 0);
}

TEST(Pcl, ManyViewpointsNeedAPointTypeThatHasThem) {
  PointCloud many = scan();
  many.viewpoints.resize(3, 3);
  many.viewpoints << 1, 2, 3, 4, 5, 6, 7, 8, 9;
  EXPECT_THROW(to_pcl<pcl::PointXYZ>(many), InputError);
  const PointCloud back = from_pcl(to_pcl<pcl::PointWithViewpoint>(many));
  EXPECT_EQ(back.points, many.points);
  EXPECT_EQ(back.viewpoints, many.viewpoints);
  // The same one for each is one for all.
  many.viewpoints.rowwise() = scan().viewpoints.row(0);
  EXPECT_EQ(from_pcl(to_pcl<pcl::PointXYZ>(many)).viewpoints, scan().viewpoints);
}

TEST(Pcl, RefusesWhatCannotBe) {
  EXPECT_THROW(from_pcl(pcl::PointCloud<pcl::PointXYZ>{}), InputError);
  pcl::PointCloud<pcl::PointXYZ> nothing(2, 1);
  nothing[0].x = nothing[1].z = std::numeric_limits<float>::infinity();
  EXPECT_THROW(from_pcl(nothing), InputError);
  PointCloud far = scan();
  far.points(2, 1) = 1e300;
  try {
    to_pcl<pcl::PointXYZ>(far);
    FAIL() << "1e300 is no float";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "point 2: its position is beyond single precision");
  }
}

}  // namespace
}  // namespace orbifit

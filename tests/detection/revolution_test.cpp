#include "primitives/revolution.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "orbifit/model/motion.h"

#include "base/random.h"

namespace orbifit {
namespace {

using Eigen::Vector3d;

constexpr double kAngle = 0.1;  // radians

struct OrientedPoints {
  Points points, normals;
};

// Half of a turn of a profile about the z axis. \param profile gives (radius, z, normal's radial part, normal's z)
struct Solid {
  std::string name;
  std::function<Eigen::Vector4d(Random&)> profile;
};

OrientedPoints sampled(const Solid& solid, int count, Random& random, double turn = std::numbers::pi) {
  OrientedPoints result{Points(count, 3), Points(count, 3)};
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector4d at = solid.profile(random);
    const double angle = random.uniform(0, turn);
    const Vector3d out(std::cos(angle), std::sin(angle), 0);
    result.points.row(i) = at[0] * out + at[1] * Vector3d::UnitZ();
    result.normals.row(i) = (at[2] * out + at[3] * Vector3d::UnitZ()).normalized();
  }
  return result;
}

Solid cylinder() {
  return {"cylinder", [](Random& random) { return Eigen::Vector4d(1, random.uniform(-1, 1), 1, 0); }};
}

Solid cone() {
  return {"cone", [](Random& random) {
            const double along = random.uniform(0.2, 1);
            return Eigen::Vector4d(along, -1.5 * along, 1.5, 1);
          }};
}

Solid torus() {
  return {"torus", [](Random& random) {
            const double angle = random.uniform(0, 2 * std::numbers::pi);
            return Eigen::Vector4d(1 + 0.3 * std::cos(angle), 0.3 * std::sin(angle), std::cos(angle), std::sin(angle));
          }};
}

Solid vase() {
  return {"vase", [](Random& random) {
            const double z = random.uniform(-1.5, 1.5);
            return Eigen::Vector4d(1 + 0.4 * std::sin(2 * z), z, 1, -0.8 * std::cos(2 * z));
          }};
}

Solid sphere() {
  return {"sphere", [](Random& random) {
            const double z = random.uniform(-1, 1);
            const double r = std::sqrt(1 - z * z);
            return Eigen::Vector4d(r, z, r, z);
          }};
}

Solid disc() {
  return {"plane", [](Random& random) { return Eigen::Vector4d(std::sqrt(random.uniform()), 0, 0, 1); }};
}

void move(OrientedPoints& cloud, const Similarity& to) {
  cloud.points = to.scale * cloud.points * to.linear.transpose();
  cloud.points.rowwise() += to.translation.transpose();
  cloud.normals *= to.linear.transpose();
}

Similarity any_place(Random& random) {
  return {std::pow(10, random.uniform(-3, 3)), random.rotation(), 100 * random.direction()};
}

// Radians between the two directions, and how far the true axis runs from the fitted one at the true centre.
double angle_off(const RevolutionFit& fit, const Similarity& to) {
  return fit.axis.direction.cross(to.linear.col(2)).norm();
}

double distance_off(const RevolutionFit& fit, const Similarity& to) {
  return (to.translation - fit.axis.point).cross(fit.axis.direction).norm() / to.scale;
}

void shake(OrientedPoints& cloud, double length, double radians, Random& random) {
  for (Eigen::Index i = 0; i < cloud.points.rows(); ++i) {
    cloud.points.row(i) += length * Vector3d(random.normal(), random.normal(), random.normal()).transpose();
    cloud.normals.row(i) += radians * Vector3d(random.normal(), random.normal(), random.normal()).transpose();
    cloud.normals.row(i).normalize();
  }
}

void spoil(OrientedPoints& cloud, double share, Random& random) {
  for (Eigen::Index i = 0; i < cloud.points.rows(); ++i) {
    if (random.uniform() >= share) continue;
    for (int k = 0; k < 3; ++k) cloud.points(i, k) = random.uniform(-1.5, 1.5);
    cloud.normals.row(i) = random.direction().transpose();
  }
}

class Turned : public testing::TestWithParam<Solid> {};

TEST_P(Turned, ItsAxisIsFound) {
  Random random(1, GetParam().name);
  for (int trial = 0; trial < 5; ++trial) {
    OrientedPoints cloud = sampled(GetParam(), 300, random);
    const Similarity to = any_place(random);
    move(cloud, to);
    const auto fit = fit_axis_of_revolution(cloud.points, cloud.normals, {}, kAngle);
    ASSERT_TRUE(fit.has_value());
    EXPECT_FALSE(fit->planar);
    EXPECT_FALSE(fit->spherical);
    EXPECT_NEAR(fit->inliers, 1, 1e-12);
    EXPECT_NEAR(fit->axis.direction.norm(), 1, 1e-12);
    EXPECT_LT(angle_off(*fit, to), 1e-6);
    EXPECT_LT(distance_off(*fit, to), 1e-6);
  }
}

TEST_P(Turned, ItsAxisIsFoundInNoise) {
  Random random(2, GetParam().name);
  OrientedPoints cloud = sampled(GetParam(), 2000, random);
  shake(cloud, 0.005, 0.02, random);
  const Similarity to = any_place(random);
  move(cloud, to);
  const auto fit = fit_axis_of_revolution(cloud.points, cloud.normals, {}, kAngle);
  ASSERT_TRUE(fit.has_value());
  EXPECT_GT(fit->inliers, 0.95);
  EXPECT_LT(angle_off(*fit, to), 0.01);
  EXPECT_LT(distance_off(*fit, to), 0.02);
}

TEST_P(Turned, ItsAxisIsFoundAmongOutliers) {
  Random random(3, GetParam().name);
  OrientedPoints cloud = sampled(GetParam(), 3000, random, 2 * std::numbers::pi);
  spoil(cloud, 0.4, random);
  const Similarity to = any_place(random);
  move(cloud, to);
  const auto fit = fit_axis_of_revolution(cloud.points, cloud.normals, {}, kAngle);
  ASSERT_TRUE(fit.has_value());
  EXPECT_GT(fit->inliers, 0.58);
  EXPECT_LT(fit->inliers, 0.75) << "outliers are not counted";
  EXPECT_LT(angle_off(*fit, to), 0.005);
  EXPECT_LT(distance_off(*fit, to), 0.01);
}

TEST_P(Turned, WeightsCountAsManyPoints) {
  Random random(4, GetParam().name);
  OrientedPoints cloud = sampled(GetParam(), 400, random);
  shake(cloud, 0.005, 0.02, random);
  Eigen::VectorXd weights(400);
  OrientedPoints repeated{Points(1000, 3), Points(1000, 3)};
  Eigen::Index row = 0;
  for (Eigen::Index i = 0; i < 400; ++i) {
    const int times = static_cast<int>(i % 5);
    weights[i] = times;
    for (int k = 0; k < times; ++k, ++row) {
      repeated.points.row(row) = cloud.points.row(i);
      repeated.normals.row(row) = cloud.normals.row(i);
    }
  }
  ASSERT_EQ(row, 800);
  repeated.points.conservativeResize(row, 3);
  repeated.normals.conservativeResize(row, 3);
  const auto weighted = fit_axis_of_revolution(cloud.points, cloud.normals, weights, kAngle);
  const auto listed = fit_axis_of_revolution(repeated.points, repeated.normals, {}, kAngle);
  ASSERT_TRUE(weighted && listed);
  EXPECT_LT(weighted->axis.direction.cross(listed->axis.direction).norm(), 1e-9);
  EXPECT_NEAR(weighted->inliers, listed->inliers, 1e-12);
}

TEST_P(Turned, NormalsMayPointEitherWay) {
  Random random(5, GetParam().name);
  OrientedPoints cloud = sampled(GetParam(), 300, random);
  for (Eigen::Index i = 0; i < 300; i += 3) cloud.normals.row(i) *= -1;
  const auto fit = fit_axis_of_revolution(cloud.points, cloud.normals, {}, kAngle);
  ASSERT_TRUE(fit.has_value());
  EXPECT_LT(angle_off(*fit, {}), 1e-6);
  EXPECT_LT(distance_off(*fit, {}), 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Solids, Turned, testing::Values(cylinder(), cone(), torus(), vase()),
                         [](const auto& each) { return each.param.name; });

TEST(FitAxisOfRevolution, EveryLineThroughTheCentreOfASphereWillDo) {
  Random random(6);
  for (const double turn : {std::numbers::pi, 2 * std::numbers::pi}) {
    OrientedPoints cloud = sampled(sphere(), 500, random, turn);
    const Similarity to = any_place(random);
    move(cloud, to);
    const auto fit = fit_axis_of_revolution(cloud.points, cloud.normals, {}, kAngle);
    ASSERT_TRUE(fit.has_value());
    EXPECT_TRUE(fit->spherical);
    EXPECT_FALSE(fit->planar);
    EXPECT_LT(distance_off(*fit, to), 1e-6);
    EXPECT_NEAR(fit->inliers, 1, 1e-12);
  }
}

TEST(FitAxisOfRevolution, OfAPlaneIsItsNormalThroughTheCentroid) {
  Random random(7);
  OrientedPoints cloud = sampled(disc(), 500, random, 2 * std::numbers::pi);
  const Similarity to = any_place(random);
  move(cloud, to);
  const auto fit = fit_axis_of_revolution(cloud.points, cloud.normals, {}, kAngle);
  ASSERT_TRUE(fit.has_value());
  EXPECT_TRUE(fit->planar);
  EXPECT_LT(angle_off(*fit, to), 1e-6);
  const Vector3d centroid = cloud.points.colwise().mean();
  EXPECT_LT((centroid - fit->axis.point).cross(fit->axis.direction).norm(), 1e-6 * to.scale);
}

TEST(FitAxisOfRevolution, NothingTurnsAScrewOrARandomCloud) {
  Random random(8);
  // A ribbon that winds about the axis twice: it moves along a screw, which is no rotation.
  OrientedPoints ribbon{Points(1000, 3), Points(1000, 3)};
  for (int i = 0; i < 1000; ++i) {
    const double angle = random.uniform(0, 4 * std::numbers::pi);
    const double radius = random.uniform(0.3, 1);
    const double pitch = 0.5;
    ribbon.points.row(i) << radius * std::cos(angle), radius * std::sin(angle), pitch * angle;
    const Vector3d along(-radius * std::sin(angle), radius * std::cos(angle), pitch);
    ribbon.normals.row(i) = along.cross(Vector3d(std::cos(angle), std::sin(angle), 0)).normalized();
  }
  EXPECT_FALSE(fit_axis_of_revolution(ribbon.points, ribbon.normals, {}, kAngle).has_value());
  OrientedPoints cloud = sampled(cylinder(), 1000, random);
  spoil(cloud, 1, random);
  EXPECT_FALSE(fit_axis_of_revolution(cloud.points, cloud.normals, {}, kAngle).has_value());
}

TEST(FitAxisOfRevolution, RefusesWhatIsTooLittle) {
  Random random(9);
  const OrientedPoints cloud = sampled(cylinder(), 5, random);
  EXPECT_FALSE(fit_axis_of_revolution(cloud.points, cloud.normals, {}, kAngle).has_value());
  const OrientedPoints more = sampled(cylinder(), 50, random);
  EXPECT_FALSE(fit_axis_of_revolution(more.points, more.normals, Eigen::VectorXd::Zero(50), kAngle).has_value());
  const Points same = Points::Ones(50, 3);
  EXPECT_FALSE(fit_axis_of_revolution(same, more.normals, {}, kAngle).has_value());
}

}  // namespace
}  // namespace orbifit

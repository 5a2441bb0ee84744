#include <cmath>
#include <map>
#include <numbers>
#include <string>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/datasets_tools/virtual_scan.h"
#include "orbifit/fitting/fit.h"

#include "base/random.h"

namespace orbifit {
namespace {

using Eigen::Vector3d;

// Errors along the rays as depth cameras have them: of every width, as much in each octave, and a third of it apart
// from one point to the next.
void add_sensor_errors(double share, PointCloud& scan) {
  constexpr int kOctaves = 5, kWavesEach = 3;
  const double size = diagonal(scan.points);
  Random random(7);
  const auto direction = [&] { return Vector3d(random.normal(), random.normal(), random.normal()).normalized(); };
  Eigen::VectorXd error = Eigen::VectorXd::Zero(scan.points.rows());
  for (int octave = 0; octave < kOctaves; ++octave) {
    for (int wave = 0; wave < kWavesEach; ++wave) {
      const Vector3d along = 2 * std::numbers::pi * std::pow(2, octave) / size * direction();
      const double phase = random.uniform(0, 2 * std::numbers::pi);
      error.array() += ((scan.points * along).array() + phase).sin() * std::sqrt(2.0 / (kOctaves * kWavesEach));
    }
  }
  for (double& each : error) each = share * size * (each + random.normal() / 3);
  for (Eigen::Index i = 0; i < scan.points.rows(); ++i) {
    const auto from = scan.viewpoints.row(scan.viewpoints.rows() == 1 ? 0 : i);
    scan.points.row(i) += error[i] * (scan.points.row(i) - from).normalized();
  }
}

// How far a shape is from another in the pose and size that suit it best, root mean square, fraction of the diagonal.
double apart(const Mesh& shape, const Mesh& other) {
  const Eigen::Matrix3Xd from = other.vertices.transpose();
  const Eigen::Matrix3Xd to = shape.vertices.transpose();
  const Eigen::Matrix4d best = Eigen::umeyama(from, to, true);
  const Eigen::Matrix3Xd put = (best.topLeftCorner<3, 3>() * from).colwise() + best.topRightCorner<3, 1>();
  return std::sqrt((put - to).colwise().squaredNorm().mean()) / diagonal(shape.vertices);
}

// Root mean square distance of a surface from its centre: by its second moments.
double spread(const Mesh& mesh) {
  double area = 0, squared = 0;
  Vector3d sum = Vector3d::Zero();
  for (Eigen::Index face = 0; face < mesh.faces.rows(); ++face) {
    const Eigen::Matrix3d corners = mesh.vertices(mesh.faces.row(face), Eigen::all);
    const Vector3d total = corners.colwise().sum();
    const double of_face = (corners.row(1) - corners.row(0)).cross(corners.row(2) - corners.row(0)).norm() / 2;
    area += of_face;
    sum += of_face * total / 3;
    squared += of_face * (corners.squaredNorm() + total.squaredNorm()) / 12;
  }
  return std::sqrt(squared / area - (sum / area).squaredNorm());
}

struct Case {
  const char* model;
  std::map<std::string, double> lengths;  // of the shape that differs

  friend void PrintTo(const Case& each, std::ostream* out) { *out << each.model; }
};

class SimplestFit : public testing::TestWithParam<Case> {
 protected:
  FitResult fitted(const Mesh& truth) {
    PointCloud scan = virtual_scan(truth, {}, context_);
    add_sensor_errors(0.004, scan);
    FitOptions options;
    options.place = true;
    return fit({template_.mesh, template_.truth, scan, Similarity{}}, options, context_);
  }

  RunContext context_;
  GeneratedModel template_ = generate(GetParam().model);
};

TEST_P(SimplestFit, TakesNoSensorsErrorForShape) {
  const FitResult result = fitted(template_.mesh);
  ASSERT_TRUE(result.converged) << result.stopped_because;
  EXPECT_EQ(result.pose.scale, 1);
  EXPECT_TRUE(result.own_size);
  EXPECT_LT(std::abs(result.growth), 0.002);
  EXPECT_LT(apart(result.fitted, template_.mesh), 0.001);
}

TEST_P(SimplestFit, FollowsAShapeThatDiffersByMore) {
  const Mesh other = generate(GetParam().model, GetParam().lengths).mesh;
  const FitResult result = fitted(other);
  ASSERT_TRUE(result.converged) << result.stopped_because;
  EXPECT_LT(apart(result.fitted, other), 0.5 * apart(template_.mesh, other));
  EXPECT_EQ(result.own_size, result.pose.scale == 1);
  EXPECT_NEAR(result.pose.scale * (1 + result.growth), spread(result.fitted) / spread(template_.mesh), 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Models, SimplestFit,
                         testing::Values(Case{"table", {{"width", 1.1}, {"height", 0.66}}},
                                         Case{"chair",
                                              {{"seat_width", 0.5}, {"seat_depth", 0.5}, {"leg_height", 0.5}}}));

}  // namespace
}  // namespace orbifit

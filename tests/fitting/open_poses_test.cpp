#include "assessment/open_poses.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "orbifit/model/annotation.h"

#include "support/cuboid.h"

namespace orbifit {
namespace {

using Eigen::Vector3d;

// A cuboid with a knob on its face of low x, placed as it is and in some ways more.
class OpenPoses : public testing::Test {
 protected:
  OpenPoses() {
    result_.fitted = cuboid();
    for (auto vertex : result_.fitted.vertices.rowwise()) {
      if (vertex.x() < 0 && std::abs(vertex.x() + 1.5) < 1e-9 && std::hypot(vertex.y(), vertex.z()) < 0.4) {
        vertex.x() -= kKnob;
      }
    }
    place({});
  }

  void place(const Similarity& pose) {
    Placement placement;
    placement.pose = pose;
    result_.placements.push_back(placement);
  }

  static Similarity half_turn(const Vector3d& axis) { return {1, axis_rotation(axis, std::numbers::pi), {0, 0, 0}}; }

  // Of a scan of some faces, taken from a place or nobody knows whence.
  std::vector<OpenPose> open(const std::vector<int>& faces, const Vector3d* from = nullptr) const {
    const PreparedScan scan = scan_of_faces(result_.fitted, faces);
    PointCloud cloud;
    cloud.points = scan.points;
    if (from != nullptr) cloud.viewpoints = from->transpose();
    return open_poses(scan, SeenSurface(cloud, scan.points), {}, RunContext{}, result_);
  }

  static constexpr double kKnob = 0.5;
  const std::vector<int> tube_{2, 3, 4, 5};  // without both faces across x
  FitResult result_;
};

TEST_F(OpenPoses, AreNoneOfOnePlacementOrNone) {
  EXPECT_TRUE(open(tube_).empty());
  result_.placements.clear();
  EXPECT_TRUE(open(tube_).empty());
}

TEST_F(OpenPoses, TellWhereTheyDiffer) {
  place(half_turn(Vector3d::UnitZ()));
  const std::vector<OpenPose> found = open(tube_);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].apart, kKnob / diagonal(result_.fitted.vertices), 0.01);
  EXPECT_NEAR(found[0].at.x(), 1.5 + kKnob, 0.02);
  EXPECT_LT(std::hypot(found[0].at.y(), found[0].at.z()), 0.5);
}

TEST_F(OpenPoses, AreNoneWhereTheDifferenceIsSeen) {
  place(half_turn(Vector3d::UnitZ()));
  EXPECT_TRUE(open({0, 1, 2, 3, 4, 5}).empty());
}

// A half-turn about y has the knob at the other end as well.
TEST_F(OpenPoses, ThatBringTheSurfaceToTheSamePlaceAreOne) {
  place(half_turn(Vector3d::UnitZ()));
  place(half_turn(Vector3d::UnitY()));
  EXPECT_EQ(open(tube_).size(), 1U);
}

TEST_F(OpenPoses, AreNotThoseThatBringTheSurfaceOntoItself) {
  place(half_turn(Vector3d::UnitX()));
  EXPECT_TRUE(open(tube_).empty());
}

// Three faces say nothing of where the others are: about a corner the cuboid may grow. That is told as an open size.
TEST_F(OpenPoses, AreNotThoseOfAnotherSize) {
  const Vector3d corner(1.5, 1, 0.5);
  for (const double scale : {0.93, 1.07}) {
    place({scale, Eigen::Matrix3d::Identity(), corner - scale * corner});
  }
  EXPECT_TRUE(open({1, 3, 5}).empty());
}

TEST_F(OpenPoses, AreNotThoseThatAViewpointContradicts) {
  // Turned, the knob would stand where the scan has seen through to the face behind.
  place(half_turn(Vector3d::UnitZ()));
  const Vector3d from(9, 4, 2);
  EXPECT_TRUE(open({1, 3, 5}, &from).empty());
}

TEST_F(OpenPoses, LowerTheConfidenceOfAFit) {
  const Mesh& mesh = result_.fitted;
  PointCloud scan;
  scan.points = scan_of_faces(mesh, tube_).points;
  FitOptions options;
  options.place = true;
  const SymmetryAnnotation none = empty_annotation(mesh, 0.005);
  const FitResult found = fit({mesh, none, scan, Similarity{}}, options, RunContext{});
  ASSERT_TRUE(found.converged) << found.stopped_because;
  EXPECT_NEAR(found.open_distance(), kKnob / diagonal(mesh.vertices), 0.02);
  EXPECT_LE(found.confidence, found.inlier_ratio * (1 - found.open_stretch()) * (1 - found.open_distance()) + 1e-12);
}

}  // namespace
}  // namespace orbifit

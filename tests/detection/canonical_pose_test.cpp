#include "surface/canonical_pose.h"

#include <algorithm>
#include <functional>
#include <numbers>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "base/random.h"
#include "shapes.h"

namespace orbifit {
namespace {

using Eigen::Vector3d;

struct PosedShape {
  std::string name;
  std::function<Mesh()> build;
};

void PrintTo(const PosedShape& shape, std::ostream* out) {
  *out << shape.name;
}

// The mesh moved, with its vertices, its faces and their corners in another order.
Mesh in_another_pose(const Mesh& mesh, Random& random) {
  const Motion motion{random.rotation(), 3 * diagonal(mesh.vertices) * random.direction()};
  const auto shuffled = [&](Eigen::Index count) {
    std::vector<int> order(static_cast<std::size_t>(count));
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
    for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
    return order;
  };
  const std::vector<int> place = shuffled(mesh.vertices.rows());
  const std::vector<int> face = shuffled(mesh.faces.rows());
  Mesh result = mesh;
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
    result.vertices.row(place[static_cast<std::size_t>(v)]) = motion(mesh.vertices.row(v).transpose()).transpose();
  }
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    const auto first = static_cast<Eigen::Index>(random.below(3));
    for (Eigen::Index k = 0; k < 3; ++k) {
      const int vertex = mesh.faces(face[static_cast<std::size_t>(f)], (first + k) % 3);
      result.faces(f, k) = place[static_cast<std::size_t>(vertex)];
    }
  }
  return result;
}

// Of 30 teeth, with corners at two places of each that are as far from the middle: low moments do not tell them apart.
Mesh gear() {
  std::vector<Mesh> parts;
  for (int k = 0; k < 30; ++k) {
    const Motion turn = Motion::rotation(Vector3d::UnitZ(), 2 * std::numbers::pi * k / 30, Vector3d::Zero());
    parts.push_back(test::moved(test::box(0.05, 0.1, 0.2), turn * test::shift(1, 0, 0)));
  }
  return test::joined(parts);
}

class CanonicalPoses : public testing::TestWithParam<PosedShape> {};

TEST_P(CanonicalPoses, AreTheSameFromAnyPoseAndOrder) {
  const Mesh mesh = GetParam().build();
  const CanonicalPose expected(mesh);
  Random random(4, GetParam().name);
  for (int k = 0; k < 4; ++k) {
    const CanonicalPose found(in_another_pose(mesh, random));
    EXPECT_LT((found.mesh.vertices - expected.mesh.vertices).cwiseAbs().maxCoeff(), 1e-12 * diagonal(mesh.vertices));
    EXPECT_EQ(found.mesh.faces, expected.mesh.faces);
  }
}

TEST_P(CanonicalPoses, AreTheMeshMoved) {
  const Mesh mesh = GetParam().build();
  const CanonicalPose pose(mesh);
  EXPECT_NEAR(pose.motion.linear.determinant(), 1, 1e-14);
  EXPECT_NEAR(pose.stretch, diagonal(mesh.vertices) / diagonal(pose.mesh.vertices), 1e-14);
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    const int given = pose.face_of[static_cast<std::size_t>(f)];
    Vector3d here = Vector3d::Zero();
    Vector3d there = Vector3d::Zero();
    for (int k = 0; k < 3; ++k) {
      here += pose.mesh.vertices.row(pose.mesh.faces(f, k)).transpose();
      there += pose.motion(mesh.vertices.row(mesh.faces(given, k)).transpose());
    }
    EXPECT_LT((here - there).norm(), 1e-12 * diagonal(mesh.vertices));
  }
}

// Without symmetry; with mirrors, which frames of one hand do not tell apart by distances; with axes; with corners that
// are as far as one another though no symmetry takes them there.
INSTANTIATE_TEST_SUITE_P(
    Shapes, CanonicalPoses,
    testing::Values(PosedShape{"scalene", test::scalene}, PosedShape{"hills", [] { return test::hills(12, 0); }},
                    PosedShape{"box", [] { return test::box(3, 2, 1); }},
                    PosedShape{"cube", [] { return test::box(1, 1, 1); }},
                    PosedShape{"prism", [] { return test::prism(7, 1, 2); }}, PosedShape{"gear", gear},
                    PosedShape{"two_boxes",
                               [] {
                                 return test::joined({test::box(1, 1, 1),
                                                      test::moved(test::box(1, 1, 1), test::shift(5, 0, 0)),
                                                      test::moved(test::scalene(), test::shift(2.5, 0.2, 0.1))});
                               }}),
    [](const auto& each) { return each.param.name; });

TEST(CanonicalPose, TakesWhatIsFoundBack) {
  const Mesh mesh = test::moved(test::prism(5, 1, 2), {axis_rotation(Vector3d(1, 2, 3).normalized(), 1), {4, 5, 6}});
  const CanonicalPose pose(mesh);
  const Motion there{axis_rotation(Vector3d(1, 2, 3).normalized(), 1), {4, 5, 6}};
  const Region truth = make_region(*PointGroup::parse("D5h"), there(Vector3d::Zero()), there.linear, {}, "prism");
  SymmetryAnnotation found = empty_annotation(pose.mesh, 0.01);
  found.regions = {make_region(*PointGroup::parse("D5h"), pose.motion(truth.centre), pose.motion.linear * there.linear,
                               {0, 1}, "prism")};
  found.regions[0].residual = {0.001, 0.002};
  Pattern pattern;
  pattern.generators = {Motion{Eigen::Matrix3d::Identity(), pose.motion.linear * Vector3d::UnitX()}};
  pattern.instances = {{Motion{}, {2}}, {pattern.generators[0], {3}}};
  found.patterns = {pattern};
  const SymmetryAnnotation given = pose.as_given(found, mesh);
  EXPECT_NEAR(given.tolerance * diagonal(mesh.vertices), found.tolerance * diagonal(pose.mesh.vertices), 1e-12);
  EXPECT_EQ(given.mesh_diagonal, diagonal(mesh.vertices));
  const Region& region = given.regions[0];
  EXPECT_NEAR(region.residual.max * diagonal(mesh.vertices), 0.002 * diagonal(pose.mesh.vertices), 1e-12);
  ASSERT_EQ(region.elements.size(), truth.elements.size());
  EXPECT_EQ(region.elements[0].linear, Eigen::Matrix3d::Identity());
  for (std::size_t e = 0; e < truth.elements.size(); ++e) {
    EXPECT_LT(motion_distance(region.elements[e], truth.elements[e], truth.centre, 1), 1e-12);
  }
  std::vector<int> faces{pose.face_of[0], pose.face_of[1]};
  std::ranges::sort(faces);
  EXPECT_EQ(region.faces, faces);
  EXPECT_EQ(given.patterns[0].instances[0].motion.linear, Eigen::Matrix3d::Identity());
  EXPECT_EQ(given.patterns[0].instances[1].motion.linear, Eigen::Matrix3d::Identity());
  EXPECT_LT((given.patterns[0].instances[1].motion.translation - Vector3d::UnitX()).norm(), 1e-14);
  EXPECT_EQ(given.patterns[0].instances[1].faces, std::vector<int>{pose.face_of[3]});
}

}  // namespace
}  // namespace orbifit

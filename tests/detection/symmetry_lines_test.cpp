#include "primitives/symmetry_lines.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "base/random.h"
#include "shapes.h"

namespace orbifit {
namespace {

using Eigen::Vector3d;

struct Suggested {
  PreparedMesh prepared;
  SymmetryLines lines;
};

Suggested suggested_by(const std::vector<Mesh>& parts, const Motion& pose = {}) {
  Suggested result{prepare(test::moved(test::joined(parts), pose)), {}};
  const ComponentSurvey survey = survey_components(result.prepared, test::kTolerance, 0, RunContext{});
  result.lines = find_symmetry_lines(result.prepared, survey, test::kTolerance);
  return result;
}

// The place of the line among these, -1 for none; lines of the input's frame.
int place_of(const std::vector<CandidateLine>& lines, const PreparedMesh& prepared, const Line& sought, bool planes) {
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const Vector3d direction = prepared.input_of_normalised.linear * lines[i].line.direction;
    if (direction.cross(sought.direction).norm() > 0.01) continue;
    const Vector3d apart = prepared.input_of_normalised(lines[i].line.point) - sought.point;
    const double off = planes ? std::abs(apart.dot(sought.direction)) : apart.cross(sought.direction).norm();
    if (off < test::kTolerance * prepared.input_of_normalised.scale) return static_cast<int>(i);
  }
  return -1;
}

int axis_place(const Suggested& found, const Line& axis) {
  return place_of(found.lines.axes, found.prepared, axis, false);
}

int plane_place(const Suggested& found, const Line& plane) {
  return place_of(found.lines.planes, found.prepared, plane, true);
}

void expect_in_order(const std::vector<CandidateLine>& lines) {
  EXPECT_TRUE(std::ranges::is_sorted(lines, std::greater<>(), &CandidateLine::weight));
  for (const CandidateLine& each : lines) {
    EXPECT_NEAR(each.line.direction.norm(), 1, 1e-9);
    EXPECT_TRUE(each.line.point.allFinite());
    EXPECT_GT(each.weight, 0);
  }
}

Mesh turned(const Mesh& mesh, double angle) {
  return test::moved(mesh, Motion::rotation(Vector3d::UnitZ(), angle, Vector3d::Zero()));
}

Motion any_pose(Random& random) {
  return {random.rotation(), 5 * random.direction()};
}

class Ring : public testing::TestWithParam<int> {};

TEST_P(Ring, OfPartsWithoutSymmetryGivesItsAxis) {
  const int n = GetParam();
  Random random(1, std::to_string(n));
  std::vector<Mesh> parts;
  const Mesh part = test::moved(test::scalene(), {random.rotation(), {2.5, 0, 0.3}});
  for (int i = 0; i < n; ++i) parts.push_back(turned(part, 2 * std::numbers::pi * i / n));
  parts.push_back(test::moved(test::box(0.7, 0.4, 0.3), {random.rotation(), {0.2, 0.1, 2}}));
  const Motion pose = any_pose(random);
  const Suggested found = suggested_by(parts, pose);
  EXPECT_EQ(axis_place(found, {pose(Vector3d::Zero()), pose.linear.col(2)}), 0) << "the heaviest";
  expect_in_order(found.lines.axes);
  expect_in_order(found.lines.planes);
}

TEST_P(Ring, OfBoxesGivesItsMirrors) {
  const int n = GetParam();
  Random random(2, std::to_string(n));
  std::vector<Mesh> parts;
  const Mesh part = test::moved(test::box(0.5, 0.3, 0.8), test::shift(2.5, 0, 0.3));
  for (int i = 0; i < n; ++i) parts.push_back(turned(part, 2 * std::numbers::pi * i / n));
  const Motion pose = any_pose(random);
  const Suggested found = suggested_by(parts, pose);
  EXPECT_GE(axis_place(found, {pose(Vector3d::Zero()), pose.linear.col(2)}), 0);
  for (int i = 0; i < n; ++i) {
    const double angle = std::numbers::pi * i / n + std::numbers::pi / 2;
    const Vector3d normal = pose.linear * Vector3d(std::cos(angle), std::sin(angle), 0);
    EXPECT_GE(plane_place(found, {pose(Vector3d::Zero()), normal}), 0) << "mirror " << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Orders, Ring, testing::Values(3, 4, 5, 6, 7, 12, 16));

TEST(SymmetryLines, UnequalStepsAreNoRing) {
  std::vector<Mesh> parts;
  const Mesh part = test::moved(test::scalene(), test::shift(4, 0, 0));
  for (const double angle : {0.0, 0.6, 1.7, 3.9}) parts.push_back(turned(part, angle));
  EXPECT_EQ(axis_place(suggested_by(parts), {Vector3d::Zero(), Vector3d::UnitZ()}), -1);
}

TEST(SymmetryLines, EqualStepsOfPartsThatDoNotTurnAlongAreNoRing) {
  std::vector<Mesh> parts;
  for (int i = 0; i < 5; ++i) {
    const Motion step = Motion::rotation(Vector3d::UnitZ(), 2 * std::numbers::pi * i / 5, Vector3d::Zero());
    const Vector3d place = step(Vector3d(4, 0, 0));
    parts.push_back(test::moved(test::box(0.3, 0.5, 1.5), test::shift(place.x(), place.y(), place.z())));
    parts.back() = test::moved(parts.back(), Motion::rotation({1, 0, 0}, 0.7 * i * i, place));
  }
  EXPECT_EQ(axis_place(suggested_by(parts), {Vector3d::Zero(), Vector3d::UnitZ()}), -1);
}

class Pair : public testing::TestWithParam<int> {};

TEST_P(Pair, OfMirrorImagesGivesThePlane) {
  Random random(3, std::to_string(GetParam()));
  const Vector3d normal = random.direction();
  const Mesh part = test::moved(test::scalene(), {random.rotation(), 1.5 * normal + 0.4 * random.direction()});
  const Mesh image = test::moved(part, Motion::reflection(normal, Vector3d::Zero()));
  EXPECT_GE(plane_place(suggested_by({part, image}), {Vector3d::Zero(), normal}), 0);
}

TEST_P(Pair, AHalfTurnApartGivesTheAxis) {
  Random random(4, std::to_string(GetParam()));
  const Vector3d axis = random.direction();
  const Vector3d across = axis.unitOrthogonal();
  const Mesh part = test::moved(test::scalene(), {random.rotation(), 1.5 * across + 0.4 * random.direction()});
  const Mesh image = test::moved(part, Motion::rotation(axis, std::numbers::pi, Vector3d::Zero()));
  EXPECT_GE(axis_place(suggested_by({part, image}), {Vector3d::Zero(), axis}), 0);
}

INSTANTIATE_TEST_SUITE_P(Places, Pair, testing::Range(0, 8));

TEST(SymmetryLines, ATurnedPartGivesItsAxisAndPartsOnOneAxisAddUp) {
  Random random(5);
  const Motion pose = any_pose(random);
  const Line axis{pose(Vector3d::Zero()), pose.linear.col(2)};
  const Mesh rod = test::prism(48, 0.5, 3);
  const Mesh flange = test::moved(test::prism(48, 1.5, 0.3), test::shift(0, 0, 1));
  const Mesh aside = test::moved(test::box(0.9, 0.5, 0.4), test::shift(3, 1, 0));
  for (const auto& parts : {std::vector<Mesh>{rod, aside}, std::vector<Mesh>{rod, aside, flange}}) {
    const Suggested found = suggested_by(parts, pose);
    const int place = axis_place(found, axis);
    ASSERT_GE(place, 0);
    double area = 0;
    for (std::size_t c = 0; c < parts.size(); ++c) {
      if (c != 1) area += surface_moments(found.prepared, found.prepared.components.faces[c]).area;
    }
    EXPECT_NEAR(found.lines.axes[static_cast<std::size_t>(place)].weight, area, 1e-9);
  }
}

Mesh sheet(int n, double radius, double stretch) {
  Mesh mesh;
  mesh.vertices.resize(n, 3);
  mesh.faces.resize(n - 2, 3);
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * i / n;
    mesh.vertices.row(i) << radius * std::cos(angle), stretch * radius * std::sin(angle), 0;
  }
  for (int i = 1; i + 1 < n; ++i) mesh.faces.row(i - 1) << 0, i, i + 1;
  return mesh;
}

TEST(SymmetryLines, ARegularSheetGivesItsNormal) {
  const Mesh aside = test::moved(test::scalene(), test::shift(2, 1, 1));
  const Line axis{Vector3d::Zero(), Vector3d::UnitZ()};
  for (const int n : {3, 4, 6, 30}) EXPECT_GE(axis_place(suggested_by({sheet(n, 1, 1), aside}), axis), 0) << n;
  for (const int n : {4, 6, 30}) EXPECT_EQ(axis_place(suggested_by({sheet(n, 1, 1.3), aside}), axis), -1) << n;
}

TEST(SymmetryLines, TheWeightOfDustIsNone) {
  // A ring of specks far below a thousandth of the area says nothing.
  std::vector<Mesh> parts{test::box(4, 3, 2)};
  const Mesh speck = test::moved(test::box(0.01, 0.015, 0.02), test::shift(1, 0, 1.2));
  for (int i = 0; i < 5; ++i) parts.push_back(turned(speck, 2 * std::numbers::pi * i / 5));
  const Suggested found = suggested_by(parts);
  EXPECT_EQ(axis_place(found, {Vector3d::Zero(), Vector3d::UnitZ()}), -1);
}

}  // namespace
}  // namespace orbifit

#include "consistency/region_shapes.h"

#include <numeric>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "base/digest.h"

namespace orbifit {
namespace {

using Eigen::Vector3d;

constexpr int kColumns = 20;  // of squares of side 1
constexpr int kRows = 5;

// A strip in the plane z = 0, square by square, of two triangles each, column after column.
Mesh strip() {
  Mesh mesh;
  mesh.vertices.resize((kColumns + 1) * (kRows + 1), 3);
  for (int x = 0; x <= kColumns; ++x) {
    for (int y = 0; y <= kRows; ++y) mesh.vertices.row(x * (kRows + 1) + y) << x, y, 0;
  }
  mesh.faces.resize(2 * kColumns * kRows, 3);
  int face = 0;
  for (int x = 0; x < kColumns; ++x) {
    for (int y = 0; y < kRows; ++y) {
      const int corner = x * (kRows + 1) + y;
      mesh.faces.row(face++) << corner, corner + kRows + 1, corner + kRows + 2;
      mesh.faces.row(face++) << corner, corner + kRows + 2, corner + 1;
    }
  }
  return mesh;
}

std::vector<int> columns(int first, int count) {
  std::vector<int> faces(static_cast<std::size_t>(2 * kRows * count));
  std::iota(faces.begin(), faces.end(), 2 * kRows * first);
  return faces;
}

Motion shift(double along) {
  return {Eigen::Matrix3d::Identity(), Eigen::Vector3d(along, 0, 0)};
}

struct Answers {
  double arrived, distance;
  std::vector<int> faces;
  std::size_t work;  // that they took

  friend bool operator==(const Answers&, const Answers&) = default;
};

Answers answers_of(const RegionShapes& shapes, int from, int to, double along) {
  const std::size_t before = shapes.work();
  Answers result{shapes.arrived(from, from, shift(along), to, to), shapes.distance(from, from, shift(along), to, to),
                 shapes.image_faces(from, from, shift(along), to), 0};
  result.work = shapes.work() - before;
  return result;
}

// Two pieces of the strip, of which the one is the other shifted by 10.
struct Pieces {
  Mesh mesh = strip();
  RunContext context;
  ShapeSurface surface{mesh, 0.01, context};
  RegionShapes shapes{surface};
  int left = shapes.add(columns(0, 8));
  int right = shapes.add(columns(10, 8));
};

TEST(RegionShapes, SayWhereAMotionTakesThem) {
  Pieces pieces;
  auto& [mesh, context, surface, shapes, left, right] = pieces;
  EXPECT_EQ(shapes.arrived(left, left, shift(10), right, right), 1);
  EXPECT_LT(shapes.arrived(left, left, shift(3), right, right), 0.5);
  EXPECT_LT(shapes.distance(left, left, shift(10), right, right), 1e-12);
  EXPECT_GT(shapes.distance(left, left, shift(9), right, right), 0.01);
  EXPECT_EQ(shapes.image_faces(left, left, shift(10), right), columns(10, 8));
  EXPECT_EQ(shapes.image_faces(left, left, shift(4), left), columns(4, 4));
}

// Where an image lies on one surface, another one nearby is not the image, though it is near enough when it is alone.
// What is asked of a part of a shape is asked of that part, however small a share of the shape it is.
TEST(RegionShapes, SayItOfASmallPart) {
  const Mesh mesh = strip();
  const RunContext context;
  const ShapeSurface surface{mesh, 0.01, context};
  RegionShapes shapes(surface);
  const int all = shapes.add(columns(0, kColumns));
  for (const int face : {0, 7, 100}) {
    const int one = shapes.add({face});
    EXPECT_EQ(shapes.arrived(all, one, shift(0), all, one), 1) << face;
    EXPECT_LT(shapes.arrived(all, one, shift(kColumns), all, one), 0.5) << face;
  }
}

TEST(RegionShapes, TakeNoneForAnImageBesideTheImageItself) {
  Mesh mesh = strip();
  const Eigen::Index count = mesh.vertices.rows();
  mesh.vertices.conservativeResize(2 * count, 3);
  mesh.vertices.bottomRows(count) = mesh.vertices.topRows(count).rowwise() + Eigen::RowVector3d(0, 0, 0.005);
  const int faces = static_cast<int>(mesh.faces.rows());
  mesh.faces.conservativeResize(2 * faces, 3);
  mesh.faces.bottomRows(faces) = mesh.faces.topRows(faces).array() + static_cast<int>(count);
  const RunContext context;
  const ShapeSurface surface(mesh, 0.01, context);
  RegionShapes shapes(surface);
  std::vector<int> every(static_cast<std::size_t>(2 * faces));
  std::iota(every.begin(), every.end(), 0);
  const int all = shapes.add(every);
  const int left = shapes.add(columns(0, 8));
  const int right = shapes.add(columns(10, 8));
  std::vector<int> over = columns(10, 8);
  for (int& face : over) face += faces;
  const int above = shapes.add(over);
  EXPECT_EQ(shapes.arrived(left, left, shift(10), above, above), 1);
  EXPECT_EQ(shapes.arrived(left, all, shift(10), right, all), 1);
  EXPECT_LT(shapes.arrived(left, all, shift(10), above, all), 0.5);
}

// A long triangle and its mirror image cross in one plane, with one centroid: either lies where the other's centroid
// goes. The same whichever has the lower number.
class CrossingFaces : public testing::TestWithParam<bool> {};

TEST_P(CrossingFaces, AreBroughtByTheirCorners) {
  Mesh mesh;
  mesh.vertices.resize(6, 3);
  mesh.vertices << -1, -1, 0, 1, 0.8, 0, 0, 0.2, 0, 1, -1, 0, -1, 0.8, 0, 0, 0.2, 0;
  mesh.faces.resize(2, 3);
  mesh.faces << 0, 1, 2, 3, 4, 5;
  if (GetParam()) mesh.faces.row(0).swap(mesh.faces.row(1));
  const RunContext context;
  const ShapeSurface surface(mesh, 0.02, context);
  RegionShapes shapes(surface);
  const int all = shapes.add({0, 1});
  const int one = shapes.add({0});
  const Motion mirror = Motion::reflection(Vector3d::UnitX(), Vector3d::Zero());
  EXPECT_EQ(shapes.image_faces(one, all, mirror, all), std::vector{1});
  EXPECT_EQ(shapes.image_faces(shapes.add({1}), all, mirror, all), std::vector{0});
  EXPECT_EQ(shapes.image_faces(one, all, Motion{}, all), std::vector{0});
}

INSTANTIATE_TEST_SUITE_P(Orders, CrossingFaces, testing::Bool());

// Answers are known by the faces, not by the number, and cost as much work whether they were known or not.
TEST(RegionShapes, RememberWhatWasAskedOfTheSameFaces) {
  Pieces pieces;
  auto& [mesh, context, surface, shapes, left, right] = pieces;
  const Answers first = answers_of(shapes, left, right, 10);
  EXPECT_GT(first.work, 0U);
  EXPECT_EQ(answers_of(shapes, left, right, 10), first);
  shapes.keep(right);
  right = shapes.add(columns(9, 8));  // others under the same number
  const Answers others = answers_of(shapes, left, right, 10);
  EXPECT_NE(others.faces, first.faces);
  EXPECT_LT(others.arrived, 1);
  right = shapes.add(columns(10, 8));
  EXPECT_EQ(answers_of(shapes, left, right, 10), first);
  const Pieces fresh;
  EXPECT_EQ(answers_of(fresh.shapes, fresh.left, fresh.right, 10), first);
}

TEST(Digest, TellsOrderLengthAndPlaceApart) {
  const std::vector<int> numbers{3, 1, 4, 1, 5};
  const auto of = [](std::vector<int> list) { return Digest().add(std::span<const int>(list)); };
  EXPECT_EQ(of(numbers), of(numbers));
  EXPECT_NE(of({3, 1, 4, 1}), of(numbers));
  EXPECT_NE(of({1, 3, 4, 1, 5}), of(numbers));
  EXPECT_NE(of({0}), of({}));
  EXPECT_NE(of({0, 0}), of({0}));
  EXPECT_NE(Digest().add(of({1})).add(of({2})), Digest().add(of({2})).add(of({1})));
  EXPECT_NE(Digest().add(0.0), Digest().add(-0.0));
}

}  // namespace
}  // namespace orbifit

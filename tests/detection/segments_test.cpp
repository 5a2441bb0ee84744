#include "surface/segments.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "base/random.h"
#include "shapes.h"

namespace orbifit {
namespace {

// What must hold of any segmentation, whatever the mesh.
void expect_partition(const PreparedMesh& prepared, const Components& segments) {
  ASSERT_EQ(segments.component_of_face.size(), static_cast<std::size_t>(prepared.mesh.faces.rows()));
  std::vector<int> seen;
  int last_first = -1;
  for (std::size_t s = 0; s < segments.faces.size(); ++s) {
    const std::vector<int>& faces = segments.faces[s];
    ASSERT_FALSE(faces.empty());
    EXPECT_TRUE(std::ranges::is_sorted(faces));
    EXPECT_GT(faces.front(), last_first) << "numbered by first appearance";
    last_first = faces.front();
    seen.insert(seen.end(), faces.begin(), faces.end());
    for (const int f : faces) {
      EXPECT_EQ(segments.component_of_face[static_cast<std::size_t>(f)], static_cast<int>(s));
      EXPECT_EQ(prepared.components.component_of_face[static_cast<std::size_t>(f)],
                prepared.components.component_of_face[static_cast<std::size_t>(faces.front())])
          << "no segment spans two components";
    }
  }
  std::ranges::sort(seen);
  EXPECT_EQ(seen, test::all_faces(prepared.mesh)) << "every face in one segment";
}

Components segments_of(const Mesh& mesh, const SegmentOptions& options = {}) {
  const PreparedMesh prepared = prepare(mesh);
  Components segments = smooth_segments(prepared, options);
  expect_partition(prepared, segments);
  return segments;
}

std::vector<std::size_t> sizes(const Components& segments) {
  std::vector<std::size_t> result;
  for (const std::vector<int>& faces : segments.faces) result.push_back(faces.size());
  std::ranges::sort(result);
  return result;
}

Mesh with_duplicates(const Mesh& mesh) {
  Mesh inside = mesh;
  inside.faces.col(1).swap(inside.faces.col(2));
  return test::joined({mesh, inside});
}

class PrismSegments : public testing::TestWithParam<int> {};

TEST_P(PrismSegments, AreSidesAndEndsUntilTheSidesAreSmooth) {
  const int n = GetParam();
  const std::size_t expected = 360.0 / n >= 25 ? static_cast<std::size_t>(n) + 2 : 3;
  const Mesh mesh = test::prism(n, 1, 1.4);
  const Components segments = segments_of(mesh);
  EXPECT_EQ(segments.faces.size(), expected);
  if (expected == 3) {
    const auto sides = static_cast<std::size_t>(2 * n);
    const auto end = static_cast<std::size_t>(n - 2);
    EXPECT_EQ(sizes(segments), (std::vector<std::size_t>{end, end, sides}));
  }
}

TEST_P(PrismSegments, TheSecondSideOfASheetChangesNothing) {
  const Mesh mesh = test::prism(GetParam(), 1, 1.4);
  const Components one = segments_of(mesh);
  const Components two = segments_of(with_duplicates(mesh));
  ASSERT_EQ(two.faces.size(), one.faces.size());
  const auto faces = static_cast<std::size_t>(mesh.faces.rows());
  for (std::size_t f = 0; f < faces; ++f) {
    EXPECT_EQ(two.component_of_face[f], one.component_of_face[f]);
    EXPECT_EQ(two.component_of_face[f + faces], one.component_of_face[f]) << "the copy lies where its original does";
  }
}

TEST_P(PrismSegments, OrientationWeldAndOrderOfFacesChangeNothing) {
  const Mesh mesh = test::prism(GetParam(), 1, 1.4);
  const Components expected = segments_of(mesh);
  Random random(3);
  const std::size_t count = expected.component_of_face.size();
  std::vector<int> order = test::all_faces(mesh);
  for (std::size_t i = count; i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
  Mesh soup;  // every face with corners of its own
  soup.vertices.resize(static_cast<Eigen::Index>(3 * count), 3);
  soup.faces.resize(static_cast<Eigen::Index>(count), 3);
  for (std::size_t f = 0; f < count; ++f) {
    for (int k = 0; k < 3; ++k) {
      const auto row = static_cast<int>(3 * f) + k;
      soup.vertices.row(row) = mesh.vertices.row(mesh.faces(order[f], k));
      soup.faces(static_cast<Eigen::Index>(f), k) = row;
    }
    if (random.below(2) == 0) {
      std::swap(soup.faces(static_cast<Eigen::Index>(f), 1), soup.faces(static_cast<Eigen::Index>(f), 2));
    }
  }
  const Components segments = segments_of(soup);
  ASSERT_EQ(segments.faces.size(), expected.faces.size());
  std::map<int, int> same;
  for (std::size_t f = 0; f < count; ++f) {
    const int here = segments.component_of_face[f];
    const int there = expected.component_of_face[static_cast<std::size_t>(order[f])];
    EXPECT_EQ(same.try_emplace(here, there).first->second, there);
  }
}

INSTANTIATE_TEST_SUITE_P(Sides, PrismSegments, testing::Values(3, 4, 6, 9, 14, 15, 40));

TEST(SmoothSegments, OfABoxAreItsSides) {
  const Components segments = segments_of(test::box(1, 2, 3));
  EXPECT_EQ(sizes(segments), (std::vector<std::size_t>{2, 2, 2, 2, 2, 2}));
}

TEST(SmoothSegments, TheCreaseAngleDecides) {
  const Mesh mesh = test::prism(12, 1, 1);  // 30 degrees from side to side
  EXPECT_EQ(segments_of(mesh, {.crease = 29}).faces.size(), 14U);
  EXPECT_EQ(segments_of(mesh, {.crease = 31}).faces.size(), 3U);
}

TEST(SmoothSegments, PartsStayApart) {
  // Two coplanar boxes in line: their sides are in one plane each, but share no edge.
  const Mesh mesh = test::joined({test::box(1, 1, 1), test::moved(test::box(1, 1, 1), test::shift(3, 0, 0))});
  EXPECT_EQ(segments_of(mesh).faces.size(), 12U);
}

TEST(SmoothSegments, AFaceWithoutAreaDoesNotBridgeACrease) {
  // A vertex on one edge of a box: the gap between the edge and its two halves is closed by a face without area.
  Mesh mesh = test::box(1, 1, 1);
  const int middle = 8;
  mesh.vertices.conservativeResize(9, 3);
  mesh.vertices.row(middle) = 0.5 * (mesh.vertices.row(0) + mesh.vertices.row(1));
  // Face 0 is 0, 2, 1, below; face 4 is 0, 1, 4, in front.
  mesh.faces.conservativeResize(14, 3);
  mesh.faces.row(0) << 0, 2, middle;
  mesh.faces.row(12) << middle, 2, 1;
  mesh.faces.row(13) << 0, middle, 1;
  const Components segments = segments_of(mesh);
  EXPECT_EQ(segments.faces.size(), 6U);
  EXPECT_NE(segments.component_of_face[0], segments.component_of_face[4]) << "below and in front";
  EXPECT_EQ(segments.component_of_face[0], segments.component_of_face[12]);
  const int follows = segments.component_of_face[13];
  EXPECT_TRUE(follows == segments.component_of_face[0] || follows == segments.component_of_face[4]);
}

TEST(SmoothSegments, EndAtEdgesOfThreeFaces) {
  // A strip of four triangles in a plane, and a fin upon the edge in its middle.
  Mesh mesh;
  mesh.vertices.resize(8, 3);
  mesh.vertices << -1, 0, 0, -1, 1, 0, 0, 0, 0, 0, 1, 0, 1, 0, 0, 1, 1, 0, 0, 0, 1, 0, 1, 1;
  mesh.faces.resize(4, 3);
  mesh.faces << 0, 2, 1, 1, 2, 3, 2, 4, 3, 3, 4, 5;
  EXPECT_EQ(segments_of(mesh).faces.size(), 1U);
  mesh.faces.conservativeResize(6, 3);
  mesh.faces.row(4) << 2, 6, 3;
  mesh.faces.row(5) << 3, 6, 7;
  EXPECT_EQ(sizes(segments_of(mesh)), (std::vector<std::size_t>{2, 2, 2}));
}

// A box of 2 x 2 x 1 whose upper edge at +x is bevelled.
Mesh bevelled(double bevel) {
  Mesh mesh;
  mesh.vertices.resize(10, 3);
  const double b = bevel;
  mesh.vertices << -1, -1, 0, 1, -1, 0, 1, -1, 1 - b, 1 - b, -1, 1, -1, -1, 1, -1, 1, 0, 1, 1, 0, 1, 1, 1 - b, 1 - b, 1,
      1, -1, 1, 1;
  mesh.faces.resize(16, 3);
  mesh.faces << 0, 1, 2, 0, 2, 3, 0, 3, 4, 5, 7, 6, 5, 8, 7, 5, 9, 8, 0, 5, 6, 0, 6, 1, 1, 6, 7, 1, 7, 2, 2, 7, 8, 2, 8,
      3, 3, 8, 9, 3, 9, 4, 4, 9, 5, 4, 5, 0;
  return mesh;
}

TEST(SmoothSegments, SliversJoinTheNeighbourAlongTheLongestBorder) {
  const Components wide = segments_of(bevelled(0.2));
  EXPECT_EQ(wide.faces.size(), 7U);
  const Components narrow = segments_of(bevelled(0.001));
  ASSERT_EQ(narrow.faces.size(), 6U);
  const int sliver = narrow.component_of_face[10];
  EXPECT_EQ(narrow.component_of_face[11], sliver);
  EXPECT_TRUE(sliver == narrow.component_of_face[8] || sliver == narrow.component_of_face[12])
      << "a long border, not one of the bevel's ends";
  EXPECT_EQ(segments_of(bevelled(0.001), {.least_share = 0}).faces.size(), 7U) << "unless told to keep them";
}

TEST(SmoothSegments, SliversOfATwoSidedSheetAreTakenToo) {
  EXPECT_EQ(segments_of(with_duplicates(bevelled(0.001))).faces.size(), 6U);
}

TEST(SmoothSegments, AFaceWhoseCornersMeetFollowsItsNeighbours) {
  // A face with two corners at one place: its one visible edge is that between a box's lower two triangles.
  Mesh mesh = test::box(1, 1, 1);
  mesh.faces.conservativeResize(13, 3);
  mesh.faces.row(12) << 1, 2, 2;
  EXPECT_EQ(segments_of(mesh).faces.size(), 6U);
}

TEST(SmoothSegments, AKnifesEdgeIsACrease) {
  // A wedge of 10 degrees: from side to side the normals turn by 170.
  const double half = std::tan(5 * std::numbers::pi / 180);
  Mesh mesh;
  mesh.vertices.resize(6, 3);
  mesh.vertices << 0, 0, 0, 0, 1, 0, 1, 0, half, 1, 1, half, 1, 0, -half, 1, 1, -half;
  mesh.faces.resize(8, 3);
  mesh.faces << 0, 2, 1, 1, 2, 3, 0, 1, 4, 1, 5, 4, 2, 4, 3, 3, 4, 5, 0, 4, 2, 1, 3, 5;
  EXPECT_EQ(segments_of(mesh).faces.size(), 5U);
}

// Faces that look up but for a share of the area, which is tilted.
class FlatPiece : public testing::TestWithParam<std::tuple<double, double>> {};

TEST_P(FlatPiece, LooksOneWayButForATenth) {
  const auto [share, degrees] = GetParam();
  const Mesh flat = test::box(1, 1 - share, 1);
  const Motion tilt =
      Motion::rotation(Eigen::Vector3d::UnitX(), degrees * std::numbers::pi / 180, Eigen::Vector3d::Zero());
  const Mesh tilted = test::moved(test::box(1, share, 1), tilt);
  const PreparedMesh prepared = prepare(test::joined({flat, test::moved(tilted, test::shift(0, 5, 0))}));
  std::vector<int> tops;
  for (int f = 0; f < prepared.mesh.faces.rows(); ++f) {
    if (prepared.normals(f, 2) > 0.8) tops.push_back(f);
  }
  EXPECT_EQ(tops.size(), 4U);
  EXPECT_EQ(flat_piece(prepared, tops), share < 0.1 || degrees < 5);
}

INSTANTIATE_TEST_SUITE_P(Tilts, FlatPiece,
                         testing::Combine(testing::Values(0.05, 0.09, 0.12, 0.3), testing::Values(2.0, 15.0, 30.0)),
                         [](const auto& each) {
                           return std::to_string(std::lround(100 * std::get<0>(each.param))) + "PercentBy" +
                                  std::to_string(std::lround(std::get<1>(each.param))) + "Degrees";
                         });

TEST(FlatPieces, AreNoSheetsOfTwoSidesNorNothing) {
  const PreparedMesh box = prepare(test::box(1, 1, 1e-3));
  std::vector<int> all(static_cast<std::size_t>(box.mesh.faces.rows()));
  std::iota(all.begin(), all.end(), 0);
  EXPECT_FALSE(flat_piece(box, all));
  EXPECT_FALSE(flat_piece(box, {}));
}

}  // namespace
}  // namespace orbifit

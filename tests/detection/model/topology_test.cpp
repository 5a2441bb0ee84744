#include "geometry/topology.h"

#include <algorithm>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "base/random.h"

namespace orbifit {
namespace {

// Outward, watertight, each side of two triangles.
Mesh cube() {
  Mesh mesh;
  mesh.vertices.resize(8, 3);
  for (int v = 0; v < 8; ++v) mesh.vertices.row(v) << (v & 1), ((v >> 1) & 1), ((v >> 2) & 1);
  mesh.faces.resize(12, 3);
  mesh.faces << 0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7,
      5;
  return mesh;
}

Mesh joined(const Mesh& a, const Mesh& b) {
  Mesh mesh;
  mesh.vertices.resize(a.vertices.rows() + b.vertices.rows(), 3);
  mesh.vertices << a.vertices, b.vertices;
  mesh.faces.resize(a.faces.rows() + b.faces.rows(), 3);
  mesh.faces << a.faces, (b.faces.array() + static_cast<int>(a.vertices.rows())).matrix();
  return mesh;
}

// Every triangle with three vertices of its own, as in an STL file.
Mesh exploded(const Mesh& mesh) {
  Mesh soup;
  soup.vertices.resize(3 * mesh.faces.rows(), 3);
  soup.faces.resize(mesh.faces.rows(), 3);
  for (int f = 0; f < mesh.faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      soup.vertices.row(3 * f + k) = mesh.vertices.row(mesh.faces(f, k));
      soup.faces(f, k) = 3 * f + k;
    }
  }
  return soup;
}

Mesh moved(Mesh mesh, double x) {
  mesh.vertices.col(0).array() += x;
  return mesh;
}

TEST(WeldVertices, OfATriangleSoupFindsTheCorners) {
  const Weld weld = weld_vertices(exploded(cube()).vertices);
  EXPECT_EQ(weld.representative.size(), 8U);
  ASSERT_EQ(weld.group_of_vertex.size(), 36U);
  EXPECT_EQ(weld.group_of_vertex[0], 0);
  EXPECT_EQ(weld.representative[0], 0);
}

TEST(WeldVertices, WithoutToleranceTellsTheLastBitApart) {
  Points points(4, 3);
  points << 1, 2, 3, 1, 2, std::nextafter(3.0, 4.0), 1, 2, 3, -0.0, 0, 0;
  EXPECT_EQ(weld_vertices(points).group_of_vertex, (std::vector<int>{0, 1, 0, 2}));
  points.row(0).setZero();
  EXPECT_EQ(weld_vertices(points).group_of_vertex, (std::vector<int>{0, 1, 2, 0}));  // -0 is 0
}

class WeldTolerance : public testing::TestWithParam<double> {};

TEST_P(WeldTolerance, GroupsAreTheBruteForceOnes) {
  Random random(1);
  Points points(600, 3);
  for (double& coordinate : points.reshaped()) coordinate = GetParam() * random.uniform(-3, 3);
  const Weld weld = weld_vertices(points, GetParam());
  std::vector<int> representative;
  for (int v = 0; v < 600; ++v) {
    int nearest = -1;
    double best = GetParam();
    for (std::size_t g = 0; g < representative.size(); ++g) {
      const double distance = (points.row(representative[g]) - points.row(v)).stableNorm();
      if (distance < best || (distance == best && nearest < 0)) {
        best = distance;
        nearest = static_cast<int>(g);
      }
    }
    if (nearest < 0) {
      nearest = static_cast<int>(representative.size());
      representative.push_back(v);
    }
    ASSERT_EQ(weld.group_of_vertex[static_cast<std::size_t>(v)], nearest) << v;
  }
  EXPECT_EQ(weld.representative, representative);
  EXPECT_LT(representative.size(), 500U);
}

INSTANTIATE_TEST_SUITE_P(Scales, WeldTolerance, testing::Values(1.0, 1e-6, 1e80, 1e-80));

TEST(WeldVertices, ToleranceIsInclusive) {
  Points points(2, 3);
  points << 0, 0, 0, 0.25, 0, 0;
  EXPECT_EQ(weld_vertices(points, 0.25).representative.size(), 1U);
  EXPECT_EQ(weld_vertices(points, 0.2499).representative.size(), 2U);
}

TEST(WeldVertices, OfNothingIsEmpty) {
  EXPECT_TRUE(weld_vertices(Points(0, 3)).representative.empty());
}

TEST(ConnectedComponents, NeedASharedEdge) {
  // The second cube touches the first in one corner, the third in a side.
  Mesh diagonal_neighbour = moved(cube(), 1);
  diagonal_neighbour.vertices.col(1).array() += 1;
  diagonal_neighbour.vertices.col(2).array() += 1;
  const Mesh corner = joined(cube(), diagonal_neighbour);
  EXPECT_EQ(connected_components(corner, weld_vertices(corner.vertices)).faces.size(), 2U);
  const Mesh side = joined(cube(), moved(cube(), 1));
  EXPECT_EQ(connected_components(side, weld_vertices(side.vertices)).faces.size(), 1U);
}

std::size_t touching(const Mesh& mesh) {
  return touching_parts(mesh, weld_vertices(mesh.vertices)).faces.size();
}

TEST(TouchingParts, StayApartWhereTheirOwnVerticesTellThem) {
  const Mesh side = joined(cube(), moved(cube(), 1));
  EXPECT_EQ(touching(side), 2U) << "a side in common";
  Mesh edge = moved(cube(), 1);
  edge.vertices.col(1).array() += 1;
  EXPECT_EQ(touching(joined(cube(), edge)), 2U) << "an edge in common";
  Mesh row = cube();
  for (int i = 1; i < 5; ++i) row = joined(row, moved(cube(), i));
  EXPECT_EQ(touching(row), 5U);
  EXPECT_EQ(touching(exploded(side)), 1U) << "a soup's vertices tell nothing";
  Mesh welded = side;
  const Weld weld = weld_vertices(side.vertices);
  for (Eigen::Index i = 0; i < welded.faces.size(); ++i) {
    int& vertex = welded.faces.data()[i];
    const int group = weld.group_of_vertex[static_cast<std::size_t>(vertex)];
    vertex = weld.representative[static_cast<std::size_t>(group)];
  }
  EXPECT_EQ(touching(welded), 1U) << "nor do shared ones";
}

TEST(TouchingParts, TwoSidesOfASheetAreOne) {
  Mesh inside = cube();
  inside.faces.col(1).swap(inside.faces.col(2));
  EXPECT_EQ(touching(joined(cube(), inside)), 1U);
  EXPECT_EQ(touching(joined(joined(cube(), inside), moved(cube(), 1))), 2U);
  const Components both = touching_parts(joined(cube(), inside), weld_vertices(joined(cube(), inside).vertices));
  EXPECT_EQ(both.faces[0].size(), 24U);
}

TEST(TouchingParts, AreTheComponentsOfAManifold) {
  for (const Mesh& mesh : {cube(), joined(cube(), moved(cube(), 3)), exploded(cube())}) {
    const Weld weld = weld_vertices(mesh.vertices);
    EXPECT_EQ(touching_parts(mesh, weld).component_of_face, connected_components(mesh, weld).component_of_face);
  }
}

TEST(TouchingParts, FinishOnManyFacesOfTheSameCorners) {
  Mesh heap;
  heap.vertices.resize(3, 3);
  heap.vertices << 0, 0, 0, 1, 0, 0, 0, 1, 0;
  heap.faces.resize(200000, 3);
  heap.faces.rowwise() = Eigen::RowVector3i(0, 1, 2);
  EXPECT_EQ(touching(heap), 1U);
  heap.faces.rowwise() = Eigen::RowVector3i(0, 1, 1);
  EXPECT_EQ(touching(heap), 1U);
}

TEST(ConnectedComponents, AreNumberedByFirstFaceWithFacesAscending) {
  Mesh mesh = exploded(joined(joined(cube(), moved(cube(), 3)), moved(cube(), 6)));
  Random random(3);
  std::vector<int> order(36);
  std::iota(order.begin(), order.end(), 0);
  for (std::size_t i = 36; i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
  mesh.faces = mesh.faces(order, Eigen::all).eval();
  const Components components = connected_components(mesh, weld_vertices(mesh.vertices));
  ASSERT_EQ(components.faces.size(), 3U);
  int previous_first = -1;
  for (std::size_t c = 0; c < 3; ++c) {
    const std::vector<int>& faces = components.faces[c];
    EXPECT_EQ(faces.size(), 12U);
    EXPECT_TRUE(std::is_sorted(faces.begin(), faces.end()));
    EXPECT_GT(faces[0], previous_first);
    previous_first = faces[0];
    for (const int face : faces) {
      EXPECT_EQ(components.component_of_face[static_cast<std::size_t>(face)], static_cast<int>(c));
      EXPECT_EQ(order[static_cast<std::size_t>(face)] / 12, order[static_cast<std::size_t>(faces[0])] / 12);
    }
  }
}

TEST(WeldedEdges, OfACubeHaveTwoFacesEach) {
  const Mesh mesh = exploded(cube());
  const std::vector<Edge> edges = welded_edges(mesh, weld_vertices(mesh.vertices));
  EXPECT_EQ(edges.size(), 18U);  // Euler: 8 - 18 + 12 = 2
  for (const Edge& edge : edges) {
    EXPECT_LT(edge.vertices[0], edge.vertices[1]);
    EXPECT_EQ(edge.faces.size(), 2U);
  }
  EXPECT_TRUE(
      std::is_sorted(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) { return a.vertices < b.vertices; }));
}

TEST(WeldedEdges, CollapsedFacesContributeNone) {
  Mesh mesh = cube();
  mesh.faces.conservativeResize(13, 3);
  mesh.faces.row(12) << 0, 0, 1;
  EXPECT_EQ(welded_edges(mesh, weld_vertices(mesh.vertices)).size(), 18U);
}

TEST(Inspect, FindsNothingWrongWithACube) {
  const MeshReport report = inspect(cube());
  EXPECT_EQ(report.vertices, 8);
  EXPECT_EQ(report.faces, 12);
  EXPECT_EQ(report.components, 1);
  EXPECT_EQ(report.duplicate_vertices + report.unused_vertices + report.degenerate_faces + report.duplicate_faces +
                report.boundary_edges + report.non_manifold_edges + report.inconsistent_edges,
            0);
  EXPECT_TRUE(report.watertight);
  EXPECT_DOUBLE_EQ(report.area, 6);
  EXPECT_DOUBLE_EQ(report.volume, 1);
  EXPECT_DOUBLE_EQ(report.diagonal, std::sqrt(3));
  EXPECT_EQ(report.minimum, Eigen::Vector3d::Zero());
  EXPECT_EQ(report.maximum, Eigen::Vector3d::Ones());
}

TEST(Inspect, CountsEachDefect) {
  Mesh open = cube();
  open.faces = open.faces.topRows(11).eval();
  EXPECT_EQ(inspect(open).boundary_edges, 3);
  EXPECT_FALSE(inspect(open).watertight);
  EXPECT_EQ(inspect(open).volume, 0);

  Mesh flipped = cube();
  flipped.faces.row(4) = flipped.faces.row(4).reverse().eval();
  EXPECT_EQ(inspect(flipped).inconsistent_edges, 3);

  Mesh doubled = cube();
  doubled.faces.conservativeResize(13, 3);
  doubled.faces.row(12) << 2, 1, 0;  // the first face again, turned
  EXPECT_EQ(inspect(doubled).duplicate_faces, 1);
  EXPECT_EQ(inspect(doubled).non_manifold_edges, 3);

  Mesh degenerate = cube();
  degenerate.vertices.conservativeResize(9, 3);
  degenerate.vertices.row(8) << 0.5, 0, 0;  // in the middle of the side from 0 to 1
  degenerate.faces.conservativeResize(14, 3);
  degenerate.faces.row(12) << 0, 8, 1;
  degenerate.faces.row(13) << 3, 3, 3;
  EXPECT_EQ(inspect(degenerate).degenerate_faces, 2);

  Mesh unused = cube();
  unused.vertices.conservativeResize(10, 3);
  unused.vertices.row(8) << 4, 4, 4;
  unused.vertices.row(9) << 1, 1, 1;
  EXPECT_EQ(inspect(unused).unused_vertices, 2);
  EXPECT_EQ(inspect(unused).duplicate_vertices, 1);

  EXPECT_EQ(inspect(exploded(cube())).duplicate_vertices, 28);
  EXPECT_TRUE(inspect(exploded(cube())).watertight);
  EXPECT_EQ(inspect(joined(cube(), moved(cube(), 5))).components, 2);
}

TEST(Inspect, VolumeIsSigned) {
  Mesh mesh = cube();
  mesh.faces = mesh.faces.rowwise().reverse().eval();
  EXPECT_DOUBLE_EQ(inspect(mesh).volume, -1);
}

}  // namespace
}  // namespace orbifit

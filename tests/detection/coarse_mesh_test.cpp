#include "resolution/coarse_mesh.h"

#include <algorithm>
#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "base/random.h"
#include "geometry/surface_index.h"
#include "shapes.h"

namespace orbifit {
namespace {

using Eigen::Vector3d;

constexpr double kWide = 0.02;  // of the diagonal, so that meshes of few faces are fine

// Three square sheets that meet in one edge.
Mesh three_sheets() {
  Mesh sheet;
  sheet.vertices.resize(4, 3);
  sheet.vertices << 0, 0, 0, 1, 0, 0, 1, 0, 1, 0, 0, 1;
  sheet.faces.resize(2, 3);
  sheet.faces << 0, 1, 2, 0, 2, 3;
  std::vector<Mesh> parts;
  for (int i = 0; i < 3; ++i) parts.push_back(test::moved(sheet, Motion::rotation({0, 0, 1}, 2.0 * i, {0, 0, 0})));
  return test::joined(parts);
}

Mesh two_sided(const Mesh& mesh) {
  Mesh inside = mesh;
  inside.faces.col(1).swap(inside.faces.col(2));
  return test::joined({mesh, inside});
}

struct Shape {
  std::string name;
  std::function<Mesh()> build;
};

void PrintTo(const Shape& shape, std::ostream* out) {
  *out << shape.name;
}

std::vector<Shape> shapes() {
  return {
      {"box", [] { return test::subdivided(test::box(1, 2, 3), 5); }},
      {"prism", [] { return test::subdivided(test::prism(7, 1, 1), 5); }},
      {"round", [] { return test::subdivided(test::prism(120, 1, 1), 3); }},
      {"plate", [] { return test::subdivided(test::box(1, 1, 0.012), 5); }},
      {"touching",
       [] {
         const Mesh box = test::box(1, 1, 1);
         return test::subdivided(
             test::joined({box, test::moved(box, test::shift(1, 0.3, 0)), test::moved(box, test::shift(0, 0.3, 1))}),
             6);
       }},
      {"small",
       [] {
         return test::subdivided(test::joined({test::box(1, 1, 1), test::box(0.01, 0.02, 0.03)}), 5);
       }},
      {"sheets", [] { return test::subdivided(three_sheets(), 6); }},
      {"doubled", [] { return test::subdivided(two_sided(test::box(1, 2, 3)), 5); }},
  };
}

CoarseMesh coarse_of(const PreparedMesh& prepared) {
  const std::optional<CoarseMesh> coarse = coarse_mesh(prepared, {kWide}, RunContext{});
  EXPECT_TRUE(coarse.has_value());
  return coarse.value_or(CoarseMesh{});
}

class CoarseMeshOf : public testing::TestWithParam<Shape> {};

TEST_P(CoarseMeshOf, StaysWhereTheFineOneIs) {
  const PreparedMesh fine = prepare(GetParam().build());
  const CoarseMesh coarse = coarse_of(fine);
  ASSERT_GT(coarse.mesh.faces.rows(), 0);
  EXPECT_LT(2 * coarse.mesh.faces.rows(), fine.mesh.faces.rows());
  const SurfaceIndex surface(coarse.mesh);
  double farthest = 0;
  for (Eigen::Index v = 0; v < fine.mesh.vertices.rows(); v += 7) {
    farthest = std::max(farthest, surface.nearest(fine.mesh.vertices.row(v)).distance);
  }
  EXPECT_LT(farthest, 0.5 * kWide);
  EXPECT_NEAR(face_areas(coarse.mesh).sum(), fine.area, 0.01 * fine.area);
}

TEST_P(CoarseMeshOf, KeepsComponentsAndStandsForEachFaceInItsOwn) {
  const PreparedMesh fine = prepare(GetParam().build());
  const CoarseMesh coarse = coarse_of(fine);
  const PreparedMesh prepared = prepare(coarse.mesh);
  ASSERT_EQ(prepared.components.faces.size(), fine.components.faces.size());
  ASSERT_EQ(coarse.proxy_face.size(), static_cast<std::size_t>(fine.mesh.faces.rows()));
  const SurfaceIndex surface(coarse.mesh);
  for (std::size_t f = 0; f < coarse.proxy_face.size(); ++f) {
    const int proxy_face = coarse.proxy_face[f];
    ASSERT_TRUE(proxy_face >= 0 && proxy_face < coarse.mesh.faces.rows());
    EXPECT_EQ(prepared.components.component_of_face[static_cast<std::size_t>(proxy_face)],
              fine.components.component_of_face[f]);
  }
}

TEST_P(CoarseMeshOf, DoesNotDependOnThreads) {
  const PreparedMesh fine = prepare(GetParam().build());
  RunContext two;
  two.threads = 2;
  const CoarseMesh one = coarse_of(fine);
  const std::optional<CoarseMesh> other = coarse_mesh(fine, {kWide}, two);
  ASSERT_TRUE(other.has_value());
  EXPECT_EQ(one.mesh.vertices, other->mesh.vertices);
  EXPECT_EQ(one.mesh.faces, other->mesh.faces);
  EXPECT_EQ(one.proxy_face, other->proxy_face);
}

INSTANTIATE_TEST_SUITE_P(Shapes, CoarseMeshOf, testing::ValuesIn(shapes()),
                         [](const auto& each) { return each.param.name; });

TEST(CoarseMesh, KeepsTheSidesOfAPlateApart) {
  const double height = 0.012;  // 0.4 tolerances
  const PreparedMesh fine = prepare(test::subdivided(test::box(1, 1, height), 5));
  const CoarseMesh coarse = coarse_of(fine);
  const double half = height / 2 / fine.input_of_normalised.scale;
  const Points normals = face_normals(coarse.mesh);
  for (std::size_t f = 0; f < coarse.proxy_face.size(); ++f) {
    const double up = fine.normals(static_cast<Eigen::Index>(f), 2);
    if (std::abs(up) < 0.5) continue;
    EXPECT_GT(up * normals(coarse.proxy_face[f], 2), 0.9);
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(coarse.mesh.vertices(coarse.mesh.faces(coarse.proxy_face[f], k), 2), up > 0 ? half : -half, 1e-9);
    }
  }
}

TEST(CoarseMesh, KeepsSharpEdgesAndBorders) {
  const Mesh sheet = three_sheets();
  for (const Mesh& mesh : {test::subdivided(sheet, 6), test::subdivided(test::box(1, 2, 3), 5)}) {
    const PreparedMesh fine = prepare(mesh);
    EXPECT_NEAR(face_areas(coarse_of(fine).mesh).sum(), fine.area, 1e-3 * fine.area);
  }
}

TEST(CoarseMesh, LeavesASoupAlone) {
  Random random(3, "soup");
  std::vector<Mesh> triangles;
  for (int i = 0; i < 300; ++i) {
    Mesh triangle;
    triangle.vertices.resize(3, 3);
    for (int k = 0; k < 3; ++k) triangle.vertices.row(k) = random.direction() + 0.02 * random.direction();
    triangle.faces.resize(1, 3);
    triangle.faces << 0, 1, 2;
    triangles.push_back(triangle);
  }
  Mesh soup = test::joined(triangles);
  const PreparedMesh prepared = prepare(soup);
  EXPECT_FALSE(coarse_mesh(prepared, {kWide}, RunContext{}).has_value());
  const std::optional<CoarseMesh> same = coarse_mesh(prepared, {kWide, 0, 1.0}, RunContext{});
  ASSERT_TRUE(same.has_value());
  EXPECT_EQ(same->mesh.faces.rows(), soup.faces.rows());
}

TEST(CoarseMesh, KeepsFacesThatAreNone) {
  Mesh mesh = test::subdivided(test::box(1, 2, 3), 5);
  const Eigen::Index count = mesh.faces.rows();
  mesh.faces.conservativeResize(count + 1, 3);
  mesh.faces.row(count) << 0, 0, 1;
  const CoarseMesh coarse = coarse_of(prepare(mesh));
  EXPECT_EQ(prepare(coarse.mesh).components.faces.size(), 2U);
  EXPECT_EQ(coarse.proxy_face.back(), coarse.mesh.faces.rows() - 1);
}

TEST(CarriedPieces, AreThoseOfTheFacesTheyStandFor) {
  const PreparedMesh fine = prepare(test::subdivided(test::box(1, 2, 3), 5));
  const CoarseMesh coarse = coarse_of(fine);
  Components sides;  // by the normal
  sides.faces.resize(6);
  for (int f = 0; f < fine.mesh.faces.rows(); ++f) {
    Eigen::Index axis = 0;
    fine.normals.row(f).cwiseAbs().maxCoeff(&axis);
    const int side = static_cast<int>(2 * axis) + (fine.normals(f, axis) > 0 ? 1 : 0);
    sides.component_of_face.push_back(side);
    sides.faces[static_cast<std::size_t>(side)].push_back(f);
  }
  const Components carried = transferred_pieces(sides, fine, coarse);
  ASSERT_EQ(carried.faces.size(), 6U);
  const Points normals = face_normals(coarse.mesh);
  for (std::size_t side = 0; side < 6; ++side) {
    for (const int f : carried.faces[side]) {
      EXPECT_NEAR(normals(f, static_cast<Eigen::Index>(side / 2)), side % 2 == 1 ? 1 : -1, 1e-9);
      EXPECT_EQ(carried.component_of_face[static_cast<std::size_t>(f)], static_cast<int>(side));
    }
  }
}

}  // namespace
}  // namespace orbifit

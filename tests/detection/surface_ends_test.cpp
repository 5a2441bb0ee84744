// What motions take past the ends of a surface.

#include "surface/surface_ends.h"

#include <vector>

#include <gtest/gtest.h>

#include "shapes.h"

namespace orbifit {
namespace {

using Eigen::Vector3d;

const std::vector<Motion> kStays{Motion()};

TEST(SurfaceEnds, AreWhereASheetStops) {
  const PreparedMesh sheet = prepare(test::sheet(20, [](double, double) { return 0.0; }));
  const SurfaceEnds ends(sheet, test::kTolerance);
  const double side = sheet.mesh.vertices.col(0).maxCoeff();
  EXPECT_TRUE(ends.taken_near({side, 0.1 * side, 0}, kStays));
  EXPECT_TRUE(ends.taken_near({side - 3 * test::kTolerance, 0, 0}, kStays));
  EXPECT_FALSE(ends.taken_near({side - 5 * test::kTolerance, 0, 0}, kStays));
  EXPECT_FALSE(ends.taken_near({side, 0, 0}, {}));
  // What one of several motions takes there counts.
  const Motion aside = Motion::reflection(Vector3d::UnitX(), Vector3d(0.75 * side, 0, 0));
  EXPECT_TRUE(ends.taken_near({0.5 * side, 0, 0}, {Motion(), aside}));
  EXPECT_FALSE(ends.taken_near({0.5 * side, 0, 0}, kStays));
}

TEST(SurfaceEnds, AClosedSurfaceHasNone) {
  const PreparedMesh box = prepare(test::box(1, 1, 1));
  const SurfaceEnds ends(box, test::kTolerance);
  for (Eigen::Index v = 0; v < box.mesh.vertices.rows(); ++v) {
    EXPECT_FALSE(ends.taken_near(box.mesh.vertices.row(v), kStays));
  }
}

TEST(SurfaceEnds, APointPastThemIsPastABrokenOneIfTheGroupDoesNotKeepIt) {
  const PreparedMesh sheet = prepare(test::sheet(20, [](double, double) { return 0.0; }));
  const SurfaceEnds ends(sheet, test::kTolerance);
  const double side = sheet.mesh.vertices.col(0).maxCoeff();
  const auto mirror_at = [](double x) {
    return std::vector<Motion>{Motion::reflection(Vector3d::UnitX(), Vector3d(x, 0, 0))};
  };
  const Vector3d beyond(1.2 * side, 0, 0);
  EXPECT_FALSE(ends.past_broken_end(beyond, *sheet.index, mirror_at(0)));
  EXPECT_TRUE(ends.past_broken_end(beyond, *sheet.index, mirror_at(0.1)));
  EXPECT_FALSE(ends.past_broken_end({0, 0, 0.1}, *sheet.index, mirror_at(0.1))) << "above the sheet";
}

TEST(SurfaceEnds, OfASceneOfPartsAreNotAsked) {
  const Mesh sheet = test::sheet(20, [](double, double) { return 0.0; });
  const PreparedMesh two = prepare(test::joined({sheet, test::moved(sheet, test::shift(0, 0, 1))}));
  const SurfaceEnds ends(two, test::kTolerance);
  EXPECT_FALSE(ends.taken_near(two.mesh.vertices.row(0), kStays));
}

TEST(SurfaceEnds, AreNotWhereSheetsMeet) {
  Mesh mesh;  // three triangles at one edge
  mesh.vertices.resize(5, 3);
  mesh.vertices << 0, 0, -1, 0, 0, 1, 1, 0, 0, -1, 1, 0, -1, -1, 0;
  mesh.faces.resize(3, 3);
  mesh.faces << 0, 1, 2, 0, 1, 3, 0, 1, 4;
  const PreparedMesh prepared = prepare(mesh);
  const SurfaceEnds ends(prepared, test::kTolerance);
  const auto point = [&](int vertex) -> Vector3d { return prepared.mesh.vertices.row(vertex); };
  EXPECT_FALSE(ends.taken_near(0.5 * (point(0) + point(1)), kStays));
  EXPECT_TRUE(ends.taken_near(0.5 * (point(0) + point(2)), kStays));
}

}  // namespace
}  // namespace orbifit

#include "primitives/featureless.h"

#include <cmath>

#include <gtest/gtest.h>

#include "shapes.h"

namespace orbifit {
namespace {

// Is the second part, with this group about its own centroid, a featureless piece of both together?
bool second_is_featureless(const Mesh& first, const Mesh& second, const char* symbol) {
  const PreparedMesh prepared = prepare(test::joined({first, second}));
  const RunContext context;
  std::vector<int> faces;
  for (int f = static_cast<int>(first.faces.rows()); f < prepared.mesh.faces.rows(); ++f) faces.push_back(f);
  const SurfacePatch patch = make_patch(prepared, faces, 400, 0.005, context, "test");
  const SurfaceIndex whole(prepared.mesh);
  const GroupPlacement placement{*PointGroup::parse(symbol), GroupFrame::Identity(), patch.moments.centroid};
  return featureless(patch, placement, whole, SurfaceEnds(prepared, 0.005), 0.005, context);
}

TEST(Featureless, ASheetOnALargerSheet) {
  const Mesh slab = test::box(4, 4, 0.01);
  EXPECT_TRUE(second_is_featureless(slab, test::moved(test::box(0.4, 0.3, 0.01), test::shift(0.5, 0.2, 0.006)), "D2h"));
  EXPECT_FALSE(second_is_featureless(slab, test::moved(test::box(0.4, 0.3, 0.5), test::shift(0.5, 0.2, 0.3)), "D2h"));
}

TEST(Featureless, ACylinderThatStandsFreeIsNot) {
  const Mesh slab = test::box(4, 4, 0.01);
  const Mesh rod = test::moved(test::prism(64, 0.2, 2), test::shift(0, 0, 2));
  EXPECT_FALSE(second_is_featureless(slab, rod, "Dinfh"));
  EXPECT_TRUE(second_is_featureless(slab, rod, "D7h")) << "it turns as freely as the seven turns map it to itself";
}

// A sheet of which a mirror beside its middle keeps the greater part: it ends before the image of one end.
TEST(Featureless, WhatASheetKeepsBesideACut) {
  for (const bool bumps : {false, true}) {
    const Mesh sheet = test::sheet(40, [&](double x, double y) {
      return bumps ? 0.05 * std::cos(40 * (x - 0.1)) * std::sin(23 * y * y + 3 * y) : 0.0;
    });
    const PreparedMesh prepared = prepare(sheet);
    const RunContext context;
    const double mirror = 0.1 / diagonal(sheet.vertices);
    std::vector<int> faces;
    for (int f = 0; f < sheet.faces.rows(); ++f) {
      if (prepared.mesh.vertices(prepared.mesh.faces.row(f), 0).minCoeff() >
          2 * mirror - prepared.mesh.vertices.col(0).maxCoeff()) {
        faces.push_back(f);
      }
    }
    const SurfacePatch patch = make_patch(prepared, faces, 400, 0.005, context, "test");
    const GroupPlacement placement{*PointGroup::parse("Cs"), frame_about(Vector3d::UnitX()), {mirror, 0, 0}};
    EXPECT_EQ(featureless(patch, placement, *prepared.index, SurfaceEnds(prepared, 0.005), 0.005, context), !bumps);
  }
}

}  // namespace
}  // namespace orbifit

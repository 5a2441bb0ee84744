#include "primitives/featureless.h"

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
  return featureless(patch, placement, whole, 0.005, context);
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

}  // namespace
}  // namespace orbifit

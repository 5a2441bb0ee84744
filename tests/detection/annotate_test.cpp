// From found regions to annotated ones.

#include "annotate.h"

#include <numbers>

#include <gtest/gtest.h>

#include "placements.h"
#include "shapes.h"

namespace orbifit {
namespace {

TEST(Annotated, LeavesOutWhatIsNoSymmetryInTheEnd) {
  // The same group of a square bar, once turned by so many degrees about its axis.
  for (const double degrees : {0.0, 0.05, 3.0, 45.0}) {
    const PreparedMesh prepared = prepare(test::subdivided(test::box(1, 1, 2), 3));
    const double angle = degrees * std::numbers::pi / 180;
    const GroupPlacement placement{*PointGroup::parse("D4h"), axis_rotation({0, 0, 1}, angle), {0, 0, 0}};
    const FoundRegion region{test::normalised(prepared, placement), test::all_faces(prepared.mesh), prepared.area,
                             "bar"};
    Explanation explanation;
    const std::vector<Region> kept = annotated(prepared, {region}, test::kTolerance, {}, &explanation);
    const bool fits = degrees < 0.1 || degrees == 45;  // half-way between its mirrors are others
    EXPECT_EQ(kept.size(), fits ? 1U : 0U) << degrees;
    EXPECT_EQ(explanation.notes.size(), fits ? 0U : 1U) << degrees;
  }
}

}  // namespace
}  // namespace orbifit

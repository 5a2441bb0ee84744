#include "orbifit/detection/refinement.h"

#include <gtest/gtest.h>

#include "orbifit/datasets_tools/orbit_model.h"
#include "orbifit/detection/verification.h"
#include "orbifit/model/random.h"

#include "shapes.h"

namespace orbifit {
namespace {

class Refine : public testing::TestWithParam<const char*> {};

TEST_P(Refine, ComesBackFromAPerturbedTruth) {
  const PointGroup group = *PointGroup::parse(GetParam());
  Random random(8, GetParam());
  OrbitOptions options;
  options.frame = random.rotation();
  const GeneratedModel model = generate_orbit(group, options);
  const PreparedMesh prepared = prepare(model.mesh);
  const RunContext context;
  const SurfacePatch patch = make_patch(prepared, test::all_faces(model.mesh), 2000, 0.005, context, "test");
  GroupPlacement start{group, options.frame, patch.moments.centroid};
  start.frame = axis_rotation(random.direction(), 0.01) * start.frame;
  start.centre += 0.003 * random.direction();
  const GroupPlacement refined = refine(patch, start);
  const auto before = measure_residual(patch, judged_motions(group, start.frame, start.centre), context);
  const auto after = measure_residual(patch, judged_motions(group, refined.frame, refined.centre), context);
  EXPECT_GT(before.rms, 1e-3);
  EXPECT_LT(after.rms, 2e-5);
  const GroupPlacement exact = refine_on_vertices(patch, refined);
  EXPECT_LT(measure_residual(patch, judged_motions(group, exact.frame, exact.centre), context).max, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Groups, Refine,
                         testing::Values("Cs", "Ci", "C2", "C5", "C4v", "C3h", "D3", "D2d", "D6h", "S6", "T", "Oh",
                                         "I"));

TEST(RefineOnVertices, LeavesAloneWhatHasNoMatchingVertices) {
  // A square's sides cut differently: the surface has the group, the vertices do not.
  Mesh mesh = test::box(1, 1, 0.5);
  mesh.vertices.conservativeResize(9, 3);
  mesh.vertices.row(8) << 0.13, 0.5, 0.25;
  mesh.faces.conservativeResize(12, 3);
  const PreparedMesh prepared = prepare(mesh);
  const RunContext context;
  const SurfacePatch patch = make_patch(prepared, test::all_faces(mesh), 500, 0.005, context, "test");
  const GroupPlacement start{*PointGroup::parse("C3"), GroupFrame::Identity(), Eigen::Vector3d::Zero()};
  const GroupPlacement end = refine_on_vertices(patch, start);
  EXPECT_EQ(end.frame, start.frame);
  EXPECT_EQ(end.centre, start.centre);
}

}  // namespace
}  // namespace orbifit

#include "group/refinement.h"

#include <cmath>
#include <string>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "base/random.h"
#include "group/verification.h"
#include "models/orbit_model.h"
#include "shapes.h"

namespace orbifit {
namespace {

class Refine : public testing::TestWithParam<const char*> {
 protected:
  Refine() : group_(*PointGroup::parse(GetParam())), random_(8, GetParam()) {
    OrbitOptions options;
    options.frame = random_.rotation();
    prepared_ = prepare(generate_orbit(group_, options).mesh);
    patch_ = make_patch(prepared_, test::all_faces(prepared_.mesh), 2000, 0.005, context_, "test");
    truth_ = {group_, options.frame, patch_.moments.centroid};
  }

  GroupPlacement perturbed(double angle, double shift) {
    GroupPlacement start = truth_;
    start.frame = axis_rotation(random_.direction(), angle) * start.frame;
    start.centre += shift * random_.direction();
    return start;
  }

  Residual residual(const GroupPlacement& of) const {
    return measure_residual(patch_, judged_motions(group_, of.frame, of.centre), context_);
  }

  PointGroup group_;
  Random random_;
  RunContext context_;
  PreparedMesh prepared_;
  SurfacePatch patch_;
  GroupPlacement truth_;
};

TEST_P(Refine, ComesBackFromAPerturbedTruth) {
  const GroupPlacement start = perturbed(0.01, 0.003);
  const GroupPlacement refined = refine(patch_, start, context_);
  EXPECT_GT(residual(start).rms, 1e-3);
  EXPECT_LT(residual(refined).rms, 2e-5);
  EXPECT_LT(residual(refine_on_vertices(patch_, refined)).max, 1e-9);
}

TEST_P(Refine, ComesBackFromFarOff) {
  // Six tolerances: only while the loss reaches far do most samples find what they are images of.
  const GroupPlacement start = perturbed(0.1, 0.03);
  EXPECT_GT(residual(start).rms, 5e-3);
  EXPECT_LT(residual(refine(patch_, start, context_)).rms, 2e-5);
}

INSTANTIATE_TEST_SUITE_P(Groups, Refine,
                         testing::Values("Cs", "Ci", "C2", "C5", "C4v", "C3h", "D3", "D2d", "D6h", "S6", "T", "Oh",
                                         "I"));

class TurnedPrism : public testing::TestWithParam<int> {};

TEST_P(TurnedPrism, GetsItsAxisFromTheCornersOfItsFacets) {
  Random random(9, std::to_string(GetParam()));
  const Mesh mesh = test::prism(GetParam(), 1, 1.4);
  const PreparedMesh prepared = prepare(mesh);
  const RunContext context;
  const SurfacePatch patch = make_patch(prepared, test::all_faces(mesh), 1000, 0.005, context, "test");
  const Eigen::Vector3d centre = inverse(prepared.input_of_normalised)(Eigen::Vector3d::Zero());
  for (const char* symbol : {"Cinf", "Cinfv", "Cinfh", "Dinf", "Dinfh"}) {
    GroupPlacement start{*PointGroup::parse(symbol), GroupFrame::Identity(), centre};
    start.frame = axis_rotation(random.direction(), 3e-4) * start.frame;
    start.centre += 3e-4 * random.direction();
    const GroupPlacement end = refine_on_vertices(patch, start);
    EXPECT_EQ(end.group, start.group);
    EXPECT_LT(end.frame.col(2).cross(Eigen::Vector3d::UnitZ()).norm(), 1e-9) << symbol;
    EXPECT_LT((end.centre - centre).head<2>().norm(), 1e-9) << symbol;
    const bool across = std::string(symbol).ends_with("h");
    EXPECT_LT(std::abs((end.centre - centre).z()), across ? 1e-9 : 1e-3) << symbol;
  }
}

INSTANTIATE_TEST_SUITE_P(Sides, TurnedPrism, testing::Values(40, 45, 49, 55));

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

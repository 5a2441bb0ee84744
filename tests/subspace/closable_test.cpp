#include "orbifit/subspace/closable.h"

#include <gtest/gtest.h>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/model/random.h"
#include "orbifit/subspace/displacement_field.h"
#include "orbifit/subspace/shared_axes.h"
#include "orbifit/subspace/subspace.h"

#include "subspaces.h"

namespace orbifit {
namespace {

// The truth of a model with every region's group moved a little, as a detector within a tolerance would have it.
SymmetryAnnotation perturbed(const GeneratedModel& model, double size) {
  Random random(6);
  SymmetryAnnotation result = model.truth;
  for (Region& region : result.regions) {
    const Motion frame{axis_rotation(random.direction(), size), size * 0.2 * random.direction()};
    for (Motion& element : region.elements) element = conjugate(frame, element);
    for (Motion& element : region.generators) element = conjugate(frame, element);
    region.centre = frame(region.centre);
    region.axis = frame.linear * region.axis;
  }
  return result;
}

class NearlySharedAxes : public testing::TestWithParam<const char*> {};

TEST_P(NearlySharedAxes, AreSharedSoThatNoRegionIsLost) {
  const GeneratedModel model = generate(GetParam());
  const SymmetryAnnotation annotation = perturbed(model, 5e-4);
  RunContext context;
  std::string said;
  context.on_message = [&](std::string_view text) { said += std::string(text) + "\n"; };
  const SymmetryAnnotation kept = closable(model.mesh, annotation, context);
  EXPECT_EQ(kept.regions.size(), annotation.regions.size()) << said;
  const Subspace subspace = build_subspace(model.mesh, kept, {}, RunContext{});
  EXPECT_GT(subspace.degrees_of_freedom(), 0);
  const SubspaceState state = random_state(subspace, 0.03);
  for (std::size_t i = 0; i < kept.regions.size(); ++i) {
    const Region& region = kept.regions[i];
    EXPECT_LT(field_residual(subspace, model.mesh, region, static_cast<int>(i), state, RunContext{}, 2000).max, 1e-7)
        << region.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Models, NearlySharedAxes, testing::Values("bar", "table", "chair"));

TEST(SharedAxes, LeaveAnExactAnnotationAsItIs) {
  const GeneratedModel model = generate("table");
  const SymmetryAnnotation shared = share_axes(model.mesh, model.truth, 0.005, MayMove::all);
  ASSERT_EQ(shared.regions.size(), model.truth.regions.size());
  for (std::size_t i = 0; i < shared.regions.size(); ++i) {
    EXPECT_LT((shared.regions[i].centre - model.truth.regions[i].centre).norm(), 1e-12);
    EXPECT_EQ(shared.regions[i].group, model.truth.regions[i].group);
  }
}

TEST(SharedAxes, LeaveAnExactRegionWhereItIs) {
  // A region that fits where it is, a little off the axes of the one around it.
  const GeneratedModel model = generate("table");
  SymmetryAnnotation annotation = model.truth;
  Region& inner = annotation.regions.back();
  const double off = 0.002 * diagonal(model.mesh.vertices);
  inner = make_region(inner.group, inner.centre + Eigen::Vector3d(off, 0, 0), frame_about(inner.axis), inner.faces,
                      inner.name);
  inner.id = model.truth.regions.back().id;
  inner.residual = {1e-12, 1e-12};
  const auto moved = [&](MayMove which) {
    const SymmetryAnnotation shared = share_axes(model.mesh, annotation, 0.005, which);
    return (shared.regions.back().centre - inner.centre).norm();
  };
  EXPECT_LT(moved(MayMove::inexact), 0.1 * off);
  EXPECT_GT(moved(MayMove::all), 0.5 * off);
}

TEST(SharedAxes, LeaveAnInexactRegionOnItsSurface) {
  // It may move by a few of its residuals, but not so far that its images leave the surface.
  const GeneratedModel model = generate("table");
  const double size = diagonal(model.mesh.vertices);
  constexpr double kTolerance = 0.005;
  for (const double off : {2e-4, 2e-3, 4e-3}) {
    SymmetryAnnotation annotation = model.truth;
    Region& inner = annotation.regions.back();
    inner = make_region(inner.group, inner.centre + Eigen::Vector3d(off * size, 0, 0), frame_about(inner.axis),
                        inner.faces, inner.name);
    inner.id = model.truth.regions.back().id;
    inner.residual = {1e-3, 2e-3};
    const SymmetryAnnotation shared = share_axes(model.mesh, annotation, kTolerance, MayMove::inexact);
    const double moved = (shared.regions.back().centre - inner.centre).norm();
    EXPECT_LE(moved, 0.25 * kTolerance * size + 1e-12) << off;
    EXPECT_GT(moved, off < 1e-3 ? 0.5 * off * size : -1.0) << off;
  }
}

TEST(Closable, LeavesOutARegionThatClashesAndSaysSo) {
  const GeneratedModel model = generate("table");
  SymmetryAnnotation annotation = model.truth;
  const std::vector<int> faces = annotation.regions[1].faces;
  Region clash = make_region(PointGroup{PointGroup::Family::Cs, 1}, {0.2, 0, 0}, frame_about(Eigen::Vector3d::UnitX()),
                             faces, "clash");
  clash.id = 99;
  annotation.regions.push_back(clash);
  RunContext context;
  std::string said;
  context.on_message = [&](std::string_view text) { said += text; };
  const SymmetryAnnotation kept = closable(model.mesh, annotation, context);
  EXPECT_EQ(kept.regions.size(), model.truth.regions.size());
  EXPECT_NE(said.find("clash"), std::string::npos) << said;
}

}  // namespace
}  // namespace orbifit

#include "models/orbit_model.h"

#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "orbifit/datasets_tools/symmetry_residual.h"
#include "orbifit/model/errors.h"

#include "base/random.h"
#include "geometry/topology.h"

namespace orbifit {
namespace {

double worst_distance(const GeneratedModel& model, const PointGroup& group, const GroupFrame& frame) {
  SymmetryAnnotation annotation = empty_annotation(model.mesh, 0.005);
  annotation.regions.push_back(
      make_region(group, model.truth.regions.front().centre, frame, model.truth.regions.front().faces, "trial"));
  RunContext context;
  return symmetry_residual(model.mesh, annotation, nullptr, CarriedMotions::fixed, context).worst_floor;
}

class OrbitModel : public testing::TestWithParam<std::string> {
 protected:
  PointGroup group_ = PointGroup::parse(GetParam()).value();
};

TEST_P(OrbitModel, HasItsGroupToRounding) {
  OrbitOptions options;
  options.centre = {3, -1, 2};
  options.radius = 2.5;
  options.frame = Random(4, GetParam()).rotation();
  const GeneratedModel model = generate_orbit(group_, options);
  ASSERT_EQ(model.truth.regions.size(), 1U);
  EXPECT_EQ(model.truth.regions.front().group, group_);
  RunContext context;
  const SymmetryReport report = symmetry_residual(model.mesh, model.truth, nullptr, CarriedMotions::fixed, context);
  EXPECT_LT(report.worst_floor, 1e-14);
  EXPECT_TRUE(report.vertices_onto_vertices);
}

TEST_P(OrbitModel, CopiesAreClosedApartAndFaceOutwards) {
  const GeneratedModel model = generate_orbit(group_);
  EXPECT_EQ(model.mesh.faces.rows(), 64 * group_.order());
  const Components components = connected_components(model.mesh, weld_vertices(model.mesh.vertices));
  EXPECT_EQ(static_cast<int>(components.faces.size()), group_.order());
  const MeshReport first = inspect(submesh(model.mesh, components.faces.front()));
  EXPECT_GT(first.volume, 0);
  for (const std::vector<int>& faces : components.faces) {
    const MeshReport copy = inspect(submesh(model.mesh, faces));
    EXPECT_TRUE(copy.watertight);
    EXPECT_NEAR(copy.volume, first.volume, 1e-14);
  }
}

using Family = PointGroup::Family;

// Groups that contain this one in the same frame, index 2.
std::vector<PointGroup> larger_groups(const PointGroup& group) {
  switch (group.family) {
    case Family::Cn:
      return {{Family::Cnv, group.n}, {Family::Cnh, group.n}, {Family::Dn, group.n}, {Family::Cn, 2 * group.n}};
    case Family::Dn:
      return {{Family::Dnh, group.n}, {Family::Dnd, group.n}};
    case Family::T:
      return {{Family::Td, 1}, {Family::Th, 1}, {Family::O, 1}};
    case Family::O:
      return {{Family::Oh, 1}};
    case Family::I:
      return {{Family::Ih, 1}};
    case Family::Td:
    case Family::Th:
      return {{Family::Oh, 1}};
    case Family::Cnv:
    case Family::Cnh:
      return {{Family::Dnh, group.n}};
    default:
      return {};
  }
}

TEST_P(OrbitModel, HasNoLargerGroup) {
  const GeneratedModel model = generate_orbit(group_);
  for (const PointGroup& larger : larger_groups(group_)) {
    for (const double angle : {0.0, 0.1, 0.5, 1.0}) {  // of the mirrors and twofold axes that the group leaves open
      const bool open = group_.family == PointGroup::Family::Cn || group_.family == PointGroup::Family::Cnh;
      if (!open && angle > 0) continue;
      EXPECT_GT(worst_distance(model, larger, axis_rotation(Eigen::Vector3d::UnitZ(), angle)), 0.005)
          << larger.symbol();
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Groups, OrbitModel,
                         testing::Values("Cs", "Ci", "C2", "C3", "C7", "C2v", "C4v", "C3h", "C5h", "D2", "D3", "D6",
                                         "D2h", "D4h", "D2d", "D3d", "D5d", "S4", "S6", "S8", "T", "Td", "Th", "O",
                                         "Oh", "I", "Ih"));

TEST(OrbitModelErrors, RefusesWhatHasNoFiniteOrbit) {
  EXPECT_THROW(generate_orbit({PointGroup::Family::Cinfv, 1}), UsageError);
  OrbitOptions options;
  options.subdivisions = 9;
  EXPECT_THROW(generate_orbit({PointGroup::Family::Cs, 1}, options), UsageError);
  options = {};
  options.radius = 0;
  EXPECT_THROW(generate_orbit({PointGroup::Family::Cs, 1}, options), UsageError);
}

TEST(OrbitModelErrors, NoGroupGivesOneCopyAndNoRegion) {
  const GeneratedModel model = generate_orbit({PointGroup::Family::C1, 1});
  EXPECT_EQ(model.mesh.faces.rows(), 64);
  EXPECT_TRUE(model.truth.regions.empty());
}

}  // namespace
}  // namespace orbifit

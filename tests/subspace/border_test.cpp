// The field is continuous where regions begin and end within one surface.

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <tuple>

#include <gtest/gtest.h>

#include "orbifit/datasets_tools/symmetry_residual.h"
#include "orbifit/subspace/displacement_field.h"

#include "base/random.h"
#include "basis/subspace_parts.h"
#include "domains/vertex_sets.h"
#include "parts.h"
#include "subspaces.h"

namespace orbifit {
namespace {

using Family = PointGroup::Family;

Eigen::Vector3d centroid(const Mesh& mesh, int face) {
  const Eigen::RowVector3i corners = mesh.faces.row(face);
  const Eigen::RowVector3d sum =
      mesh.vertices.row(corners[0]) + mesh.vertices.row(corners[1]) + mesh.vertices.row(corners[2]);
  return sum.transpose() / 3;
}

// The faces whose centroids do.
template <class Condition>
std::vector<int> faces_where(const Mesh& mesh, const Condition& condition) {
  std::vector<int> result;
  for (int f = 0; f < static_cast<int>(mesh.faces.rows()); ++f) {
    if (condition(centroid(mesh, f))) result.push_back(f);
  }
  return result;
}

std::vector<int> layer(const Mesh& mesh, double low, double high) {
  return faces_where(mesh, [&](const Eigen::Vector3d& at) { return at[2] > low && at[2] < high; });
}

void add_region(GeneratedModel& model, const PointGroup& group, std::vector<int> faces, double height = 0) {
  const Region region =
      make_region(group, {0, 0, height}, frame_about(Eigen::Vector3d::UnitZ()), std::move(faces), group.symbol());
  model.truth.regions.push_back(region);
  model.truth.regions.back().id = static_cast<int>(model.truth.regions.size()) - 1;
}

GeneratedModel box_with_cap(double cap) {
  GeneratedModel model = whole(box({0.5, 0.5, 1}, 8), {Family::Cn, 2}, {0, 0, 0});
  add_region(model, {Family::Cnv, 4}, layer(model.mesh, cap, 2));
  return model;
}

// A belt that ends inside the cap, in which the cap ends.
GeneratedModel overlapping_belt() {
  GeneratedModel model = box_with_cap(0.25);
  add_region(model, {Family::Cnv, 2}, layer(model.mesh, -0.5, 0.5));
  return model;
}

// A belt that ends where the cap begins: no face lies in both.
GeneratedModel abutting_belt() {
  GeneratedModel model = box_with_cap(0.5);
  add_region(model, {Family::Cnv, 2}, layer(model.mesh, -0.25, 0.5));
  return model;
}

// Two pairs of panels under the cap, three regions meeting at each corner; the cap's group takes one pair's border to
// the other's.
GeneratedModel panels() {
  GeneratedModel model = box_with_cap(0.5);
  for (const int axis : {0, 1}) {
    add_region(model, {Family::Cnv, 2}, faces_where(model.mesh, [&](const Eigen::Vector3d& at) {
                 return at[2] < 0.5 && at[2] > -0.5 && std::abs(at[axis]) > 0.499;
               }));
  }
  return model;
}

// Patches, symmetric up and down, above a belt that takes their lower borders to where there are none.
GeneratedModel patches() {
  GeneratedModel model = whole(box({0.5, 0.5, 1}, 8), {Family::Cn, 2}, {0, 0, 0});
  add_region(model, {Family::Cnv, 4}, layer(model.mesh, -0.5, 0.5));
  add_region(model, {Family::Cnh, 1},
             faces_where(model.mesh,
                         [](const Eigen::Vector3d& at) { return at[2] > 0.5 && at[2] < 1 && std::abs(at[0]) > 0.499; }),
             0.75);
  return model;
}

// One patch on a part whose group takes it to three more places, which are no regions.
GeneratedModel lone_patch() {
  GeneratedModel model = whole(box({0.5, 0.5, 1}, 8), {Family::Cnv, 4}, {0, 0, 0});
  add_region(
      model, {Family::Cnh, 1},
      faces_where(model.mesh, [](const Eigen::Vector3d& at) { return at[2] > -0.25 && at[2] < 0.75 && at[0] > 0.499; }),
      0.25);
  return model;
}

// A collar that any rotation keeps, on a part that only a half turn keeps; vertices are no images of one another.
GeneratedModel collared_part() {
  const Mesh mesh =
      turned_part({{0, -1}, {0.4, -1}, {0.5, -0.3}, {0.55, 0}, {0.5, 0.3}, {0.3, 0.7}, {0, 1}}, irregular_angles(31));
  GeneratedModel model = whole(mesh, {Family::Cn, 2}, {0, 0, 0});
  add_region(model, {Family::Cinfv, 1}, layer(mesh, -0.25, 0.25));
  return model;
}

GeneratedModel made(const std::string& name) {
  if (name == "collar") return collared_part();
  if (name == "box with an overlapping belt") return overlapping_belt();
  if (name == "box with an abutting belt") return abutting_belt();
  if (name == "box with patches") return patches();
  if (name == "box with a patch") return lone_patch();
  return name == "box with panels" ? panels() : box_with_cap(0.25);
}

// Two faces at an edge where places begin or end.
struct Border {
  int inside, outside;
  Eigen::Vector3d start, end;
};

std::vector<Border> borders_of(const Mesh& mesh, const RegionMap& regions) {
  const std::vector<int> weld = welded_vertices(mesh.vertices);
  std::map<std::pair<int, int>, int> first;
  std::vector<Border> result;
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const auto edge = std::minmax<int>({weld[static_cast<std::size_t>(mesh.faces(f, k))],
                                          weld[static_cast<std::size_t>(mesh.faces(f, (k + 1) % 3))]});
      const auto [known, added] = first.try_emplace(edge, static_cast<int>(f));
      if (added || regions.set_of_face(known->second) == regions.set_of_face(static_cast<int>(f))) continue;
      result.push_back({known->second, static_cast<int>(f), mesh.vertices.row(edge.first).transpose(),
                        mesh.vertices.row(edge.second).transpose()});
    }
  }
  return result;
}

using BorderModeCase = std::tuple<std::string, GroupMode>;

class BorderCase : public testing::TestWithParam<BorderModeCase> {
 protected:
  BorderCase()
      : model_(made(std::get<0>(GetParam()))),
        subspace_(subspace_of(model_, std::get<1>(GetParam()), 0.05)),
        state_(random_state(subspace_, 0.03)) {}

  // The field at shares of the way from a point of a border to the centroids of its two faces.
  Points both_sides(const Border& border, double along, double share) const {
    const Eigen::Vector3d on = border.start + along * (border.end - border.start);
    Points sides(2, 3);
    sides.row(0) = (on + share * (centroid(model_.mesh, border.inside) - on)).transpose();
    sides.row(1) = (on + share * (centroid(model_.mesh, border.outside) - on)).transpose();
    const RegionMap& regions = *subspace_->regions;
    const std::vector<int> sets{regions.set_of_face(border.inside), regions.set_of_face(border.outside)};
    return displacement_field(subspace_, state_, sides, sets, RunContext{});
  }

  double largest() const { return vertex_displacements(subspace_, state_).rowwise().norm().maxCoeff(); }

  std::string sides_of(const Border& border) const {
    const RegionMap& regions = *subspace_->regions;
    const auto name = [&](int face) { return regions.name(innermost_region(regions, regions.set_of_face(face))); };
    return name(border.inside) + " and " + name(border.outside);
  }

  void expect_exact() const {
    const WorstResidual worst = worst_residual(model_, subspace_, state_, 400);
    EXPECT_LT(worst.residual, 1e-12) << worst.name;
  }

  // Within a hundredth of the radius of a border the field is nearly constant on either side.
  void expect_no_steep_layer() const {
    const std::vector<Border> borders = borders_of(model_.mesh, *subspace_->regions);
    Random random(6, "layers");
    for (int trial = 0; trial < 12; ++trial) {
      const Border& border = borders[random.below(borders.size())];
      const Points change = both_sides(border, 0.5, 0.03) - both_sides(border, 0.5, 1e-5);
      EXPECT_LT(change.rowwise().norm().maxCoeff(), 0.1 * largest()) << sides_of(border);
    }
  }

  GeneratedModel model_;
  Subspace subspace_;
  SubspaceState state_;
};

// Where each motion of a place takes the borders in it to borders of the same kind.
class InnerBorder : public BorderCase {};

// Where motions take a border to where no region ends: the field would have to know of it there, too.
class OpenBorder : public BorderCase {};

TEST_P(OpenBorder, LeavesEveryRegionExact) {
  expect_exact();
}

TEST_P(OpenBorder, HasNoSteepLayer) {
  expect_no_steep_layer();
}

TEST_P(InnerBorder, HasNoSteepLayer) {
  expect_no_steep_layer();
}

TEST_P(InnerBorder, LeavesEveryRegionExact) {
  expect_exact();
}

// The nearer two points on either side of a border, the nearer their displacements; beside corners, where borders
// meet, too.
TEST_P(InnerBorder, IsCrossedContinuously) {
  const std::vector<Border> borders = borders_of(model_.mesh, *subspace_->regions);
  ASSERT_GT(borders.size(), 8U);
  Random random(5, "borders");
  for (int trial = 0; trial < 24; ++trial) {
    const Border& border = borders[random.below(borders.size())];
    const Points sides = both_sides(border, trial % 2 == 0 ? 0.5 : 1e-3, 1e-5);
    // A Gaussian cut at a thousandth of its height leaves a jump of that order.
    EXPECT_LT((sides.row(1) - sides.row(0)).norm(), 0.005 * largest()) << sides_of(border);
  }
}

// Where places meet without overlapping samples that lie in all of them stand along the border.
TEST_P(InnerBorder, HasSamplesOfBothSidesNearby) {
  const RegionMap& regions = *subspace_->regions;
  const SymmetricSampling& sampling = subspace_->sampling;
  for (const Border& border : borders_of(model_.mesh, regions)) {
    const int both = regions.joined(regions.set_of_face(border.inside), regions.set_of_face(border.outside));
    const Eigen::Vector3d middle = 0.5 * (border.start + border.end);
    double nearest = 1e9;
    for (std::size_t k = 0; k < sampling.sets.size(); ++k) {
      if (!regions.contains(sampling.sets[k], both)) continue;
      const auto row = static_cast<Eigen::Index>(k);
      nearest = std::min(nearest, (sampling.points.row(row).transpose() - middle).norm());
    }
    EXPECT_LT(nearest, 2 * sampling.radius) << middle.transpose();
  }
}

std::string border_case_name(const testing::TestParamInfo<BorderModeCase>& info) {
  std::string name = std::get<0>(info.param) + "_" + to_string(std::get<1>(info.param));
  std::ranges::replace(name, ' ', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Models, InnerBorder,
                         testing::Combine(testing::Values("box", "box with an overlapping belt",
                                                          "box with an abutting belt", "box with panels", "collar"),
                                          testing::Values(GroupMode::fixed, GroupMode::floating, GroupMode::moving)),
                         border_case_name);

INSTANTIATE_TEST_SUITE_P(Models, OpenBorder,
                         testing::Combine(testing::Values("box with patches", "box with a patch"),
                                          testing::Values(GroupMode::fixed, GroupMode::floating, GroupMode::moving)),
                         border_case_name);

}  // namespace
}  // namespace orbifit

// Continuous groups in closed form, on tessellations that no rotation maps onto themselves.

#include <cmath>
#include <string>
#include <tuple>

#include <gtest/gtest.h>

#include "orbifit/subspace/deformer.h"
#include "orbifit/subspace/displacement_field.h"

#include "base/random.h"
#include "basis/subspace_parts.h"
#include "parts.h"
#include "subspaces.h"

namespace orbifit {
namespace {

struct RoundKind {
  const char* symbol;
  int generic, on_axis, on_mirror, at_centre;  // degrees of freedom of a ring or sphere, by where its seed lies
  int carried;                                 // directions in which the group may float
};

const RoundKind kKinds[] = {{"Cinf", 3, 1, 3, 1, 2}, {"Cinfv", 2, 1, 2, 1, 2}, {"Cinfh", 3, 1, 2, 0, 3},
                            {"Dinf", 3, 1, 1, 0, 3}, {"Dinfh", 2, 1, 1, 0, 3}, {"K", 1, 1, 1, 0, 3},
                            {"Kh", 1, 1, 1, 0, 3}};

// A part of revolution; for K and Kh a sphere. All of them symmetric to the plane z = 0.
Mesh part_for(const PointGroup& group) {
  std::vector<Eigen::Vector2d> profile;
  constexpr int kRows = 12;
  for (int i = 0; i <= kRows; ++i) {
    const double t = M_PI * i / kRows;
    const bool pole = i == 0 || i == kRows;
    const double bulge = group.has_axis() ? 0.3 * std::cos(2 * t) : 0;
    profile.emplace_back(pole ? 0 : std::sin(t) * (1 + bulge), (group.has_axis() ? 1.6 : 1) * -std::cos(t));
  }
  return turned_part(profile, irregular_angles(23));
}

using ContinuousCase = std::tuple<int, GroupMode>;

class ContinuousGroup : public testing::TestWithParam<ContinuousCase> {
 protected:
  ContinuousGroup() : kind_(kKinds[std::get<0>(GetParam())]) {
    const PointGroup group = PointGroup::parse(kind_.symbol).value();
    const Motion pose{Eigen::Matrix3d::Identity(), {0.4, -0.3, 0.2}};
    model_ = whole(placed(part_for(group), pose), group, pose.translation);
    subspace_ = subspace_of(model_, std::get<1>(GetParam()), 0.12);
    state_ = random_state(subspace_, 0.05);
  }

  Motion random_element(Random& random) const {
    const Region& region = model_.truth.regions[0];
    const auto& components = subspace_->regions->elements(0);
    const Motion& component = components[random.below(components.size())];
    const Eigen::Matrix3d turn =
        region.group.has_axis() ? axis_rotation(region.axis, random.uniform(0, 2 * M_PI)) : random.rotation();
    return Motion::about(turn, region.centre) * component;
  }

  const RoundKind& kind_;
  GeneratedModel model_;
  Subspace subspace_;
  SubspaceState state_;
};

TEST_P(ContinuousGroup, SamplesDoNotDependOnUnits) {
  for (const double scale : {0.01, 100.0}) {
    GeneratedModel model = model_;
    model.mesh.vertices *= scale;
    model.truth = transformed(model.truth, {scale, Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero()});
    const Subspace scaled = subspace_of(model, std::get<1>(GetParam()), 0.12);
    EXPECT_EQ(scaled.samples().rows(), subspace_.samples().rows()) << scale;
    EXPECT_EQ(scaled.degrees_of_freedom(), subspace_.degrees_of_freedom()) << scale;
  }
}

// Also to points that lie nearly opposite.
TEST(Continuum, TurnsToPointsOfASphereToRounding) {
  Continuum continuum;
  continuum.spherical = true;
  continuum.centre = {0.3, -0.2, 0.5};
  for (const double off : {0.0, 1e-9, 1e-7, 1e-4, 0.1, 1.0}) {
    for (const double height : {-1.0, 1.0}) {
      const Eigen::Vector3d point = continuum.centre + Eigen::Vector3d(off, 0.5 * off, height);
      const double radius = (point - continuum.centre).norm();
      const Motion turn = continuum.turn_to(point);
      EXPECT_LT((turn(continuum.centre + radius * continuum.axis) - point).norm(), 1e-15) << off << " " << height;
      EXPECT_LT((turn.linear.transpose() * turn.linear - Eigen::Matrix3d::Identity()).norm(), 1e-15);
      EXPECT_NEAR(turn.linear.determinant(), 1, 1e-15);
    }
  }
}

TEST_P(ContinuousGroup, FieldIsExactAtAnyAngle) {
  Random random(8, "elements");
  const Motion carried = region_motion(subspace_, state_, 0);
  const int set = subspace_->regions->set_of_face(0);
  double size = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const auto vertex =
        static_cast<Eigen::Index>(random.below(static_cast<std::uint64_t>(model_.mesh.vertices.rows())));
    const Eigen::Vector3d here = model_.mesh.vertices.row(vertex).transpose();
    const Motion element = random_element(random);
    Points pair(2, 3);
    pair.row(0) = here.transpose();
    pair.row(1) = element(here).transpose();
    const Points field = displacement_field(subspace_, state_, pair, {set, set}, RunContext{});
    const Eigen::Vector3d due = conjugate(carried, element)((pair.row(0) + field.row(0)).transpose());
    ASSERT_LT((pair.row(1) + field.row(1) - due.transpose()).norm(), 1e-12 * subspace_->diagonal)
        << "vertex " << vertex;
    size = std::max(size, field.row(0).norm());
  }
  EXPECT_GT(size, 0.01 * subspace_->diagonal);
}

TEST_P(ContinuousGroup, VerticesOfOneRingAreExactCopies) {
  const Motion carried = region_motion(subspace_, state_, 0);
  const Region& region = model_.truth.regions[0];
  const Points moved = model_.mesh.vertices + vertex_displacements(subspace_, state_);
  const std::vector<double> angles = irregular_angles(23);
  for (int row = 0; row < 11; ++row) {
    const Eigen::Index first = 1 + 23 * row;
    for (int k = 1; k < 23; ++k) {
      const Motion turn = conjugate(
          carried, Motion::rotation(Eigen::Vector3d::UnitZ(), angles[static_cast<std::size_t>(k)], region.centre));
      ASSERT_LT((moved.row(first + k).transpose() - turn(moved.row(first).transpose())).norm(),
                1e-12 * subspace_->diagonal);
    }
  }
  const Residual field = field_residual(subspace_, model_.mesh, region, 0, state_, RunContext{}, 300);
  EXPECT_LT(field.max, 1e-12);
  EXPECT_LE(field.rms, field.max);
}

TEST_P(ContinuousGroup, RingsHaveTheFreedomThatTheirStabilisersLeave) {
  const Eigen::Vector3d centre = model_.truth.regions[0].centre;
  int freedom = 0;
  for (int orbit = 0; orbit < subspace_->sampling.orbits(); ++orbit) {
    const Eigen::Vector3d seed =
        subspace_->sampling.points.row(subspace_->sampling.first_sample[static_cast<std::size_t>(orbit)]).transpose() -
        centre;
    const double near = 1e-9;
    const bool on_axis = seed.head<2>().norm() < near;
    const bool level = std::abs(seed[2]) < near;
    freedom += seed.norm() < near ? kind_.at_centre : on_axis ? kind_.on_axis : level ? kind_.on_mirror : kind_.generic;
  }
  if (subspace_->mode != GroupMode::fixed) freedom += kind_.carried;
  EXPECT_EQ(subspace_.degrees_of_freedom(), freedom);
  EXPECT_EQ(basis_of(subspace_, state_).degrees_of_freedom(), freedom);
}

TEST_P(ContinuousGroup, SamplesFollowTheGroup) {
  const Points displacements = sample_displacements(subspace_, state_);
  const Motion carried = region_motion(subspace_, state_, 0);
  const SymmetricSampling& sampling = subspace_->sampling;
  int copies = 0;
  for (std::size_t k = 0; k < sampling.copies.size(); ++k) {
    const auto& copy = sampling.copies[k];
    if (copy.place < 0 || copy.first == static_cast<int>(k)) continue;
    const Eigen::Index from = copy.first;
    const auto to = static_cast<Eigen::Index>(k);
    EXPECT_LT((copy.turn(sampling.points.row(from).transpose()) - sampling.points.row(to).transpose()).norm(), 1e-12);
    const Eigen::Vector3d due =
        conjugate(carried, copy.turn)((sampling.points.row(from) + displacements.row(from)).transpose());
    EXPECT_LT((sampling.points.row(to) + displacements.row(to) - due.transpose()).norm(), 1e-12 * subspace_->diagonal);
    ++copies;
  }
  EXPECT_GT(copies, 10);
}

std::string continuous_case_name(const testing::TestParamInfo<ContinuousCase>& info) {
  return std::string(kKinds[std::get<0>(info.param)].symbol) + "_" + to_string(std::get<1>(info.param));
}

INSTANTIATE_TEST_SUITE_P(Groups, ContinuousGroup,
                         testing::Combine(testing::Range(0, 7),
                                          testing::Values(GroupMode::fixed, GroupMode::floating, GroupMode::moving)),
                         continuous_case_name);

// A body with a mirror plane and two turned wheels that it maps to one another; the wheels' tessellations differ.
GeneratedModel body_with_wheels() {
  GeneratedModel model;
  append(model.mesh, box({0.8, 1.5, 0.4}, 4));
  const Eigen::Matrix3d across = axis_rotation(Eigen::Vector3d::UnitY(), M_PI / 2);  // z -> x
  const std::vector<Eigen::Vector2d> profile{{0, -0.15}, {0.4, -0.15}, {0.5, 0}, {0.4, 0.15}, {0.2, 0.1}, {0, 0.1}};
  std::vector<Eigen::Vector2d> mirrored;
  for (auto at = profile.rbegin(); at != profile.rend(); ++at) mirrored.emplace_back((*at)[0], -(*at)[1]);
  const Mesh right = placed(turned_part(profile, irregular_angles(19)), {across, {1.1, 0.6, -0.2}});
  const Mesh left = placed(turned_part(mirrored, irregular_angles(24)), {across, {-1.1, 0.6, -0.2}});
  const std::vector<int> right_faces = append(model.mesh, right);
  const std::vector<int> left_faces = append(model.mesh, left);
  model.truth = empty_annotation(model.mesh, 0.005);
  std::vector<int> all(static_cast<std::size_t>(model.mesh.faces.rows()));
  for (std::size_t f = 0; f < all.size(); ++f) all[f] = static_cast<int>(f);
  const Eigen::Matrix3d frame = frame_about(Eigen::Vector3d::UnitX());
  model.truth.regions = {make_region(PointGroup::parse("Cs").value(), {0, 0, 0}, frame, all, "body"),
                         make_region(PointGroup::parse("Cinfv").value(), {1.1, 0.6, -0.2}, frame, right_faces, "right"),
                         make_region(PointGroup::parse("Cinfv").value(), {-1.1, 0.6, -0.2}, frame, left_faces, "left")};
  for (int i = 0; i < 3; ++i) model.truth.regions[static_cast<std::size_t>(i)].id = i;
  set_parents(model.truth.regions);
  return model;
}

class NestedContinuous : public testing::TestWithParam<GroupMode> {};

TEST_P(NestedContinuous, WheelsOfABodyWithAMirrorAreExact) {
  const GeneratedModel model = body_with_wheels();
  const Subspace subspace = subspace_of(model, GetParam(), 0.06);
  const SubspaceState state = random_state(subspace, 0.03);
  const WorstResidual worst = worst_residual(model, subspace, state, 300);
  EXPECT_LT(worst.residual, 1e-12) << worst.name;
  // The wheels are images of one another, wherever they go.
  const Motion mirror = conjugate(region_motion(subspace, state, 0), model.truth.regions[0].elements[1]);
  const Motion right = region_motion(subspace, state, 1);
  const Motion left = region_motion(subspace, state, 2);
  const Eigen::Vector3d apart = mirror(right(model.truth.regions[1].centre)) - left(model.truth.regions[2].centre);
  const Eigen::Vector3d axle = left.linear * model.truth.regions[2].axis;
  EXPECT_LT(axle.cross(apart).norm(), 1e-12 * subspace->diagonal);
}

TEST_P(NestedContinuous, SpokesInARimAreExact) {
  const GeneratedModel model = generate("wheel", {{"detail", 1}});
  int continuous = 0;
  int finite = 0;
  for (const Region& region : model.truth.regions) ++(region.group.continuous() ? continuous : finite);
  ASSERT_GT(continuous, 0);
  ASSERT_GT(finite, 0);
  const Subspace subspace = subspace_of(model, GetParam(), 0.15);
  const WorstResidual worst = worst_residual(model, subspace, random_state(subspace, 0.03), 60);
  EXPECT_LT(worst.residual, 1e-12) << worst.name;
}

INSTANTIATE_TEST_SUITE_P(Modes, NestedContinuous,
                         testing::Values(GroupMode::fixed, GroupMode::floating, GroupMode::moving),
                         [](const auto& mode) { return to_string(mode.param); });

TEST(ContinuousRegions, AreKeptWithoutAWord) {
  const GeneratedModel model = body_with_wheels();
  RunContext context;
  std::string said;
  context.on_message = [&](std::string_view text) { said += text; };
  SubspaceOptions options;
  options.radius = 0.06 * diagonal(model.mesh.vertices);
  build_subspace(model.mesh, model.truth, options, context);
  EXPECT_EQ(said, "");
}

}  // namespace
}  // namespace orbifit

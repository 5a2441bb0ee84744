#include "search/part_regions.h"

#include <algorithm>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "base/dense.h"
#include "base/random.h"
#include "group/axis_orders.h"
#include "group/verification.h"
#include "models/orbit_model.h"
#include "placements.h"
#include "shapes.h"
#include "support/region_growth.h"
#include "surface/segments.h"

namespace orbifit {
namespace {

using Eigen::Vector3d;

PartRegions regions_of(const PreparedMesh& prepared, const std::vector<FoundRegion>& known = {},
                       PartRegionOptions options = {}) {
  static const DirectionSet screen = hemisphere_directions(1500);
  const SurfaceIndex whole(prepared.mesh);
  options.tolerance = test::kTolerance;
  return find_part_regions(prepared, survey_components(prepared, options.tolerance, options.least_share, {}), whole,
                           known, screen, options, RunContext{});
}

// What must hold of every region, whatever the mesh.
void expect_sound(const PreparedMesh& prepared, const PartRegions& found) {
  for (const FoundRegion& region : found.regions) {
    EXPECT_TRUE(std::ranges::is_sorted(region.faces));
    EXPECT_NEAR(region.area, surface_moments(prepared, region.faces).area, 1e-9);
    EXPECT_GE(region.area, PartRegionOptions{}.least_share * prepared.area);
    std::vector<int> parts;
    for (const int f : region.faces) {
      parts.push_back(prepared.components.component_of_face[static_cast<std::size_t>(f)]);
    }
    std::ranges::sort(parts);
    parts.erase(std::unique(parts.begin(), parts.end()), parts.end());
    std::size_t faces = 0;
    for (const int c : parts) faces += prepared.components.faces[static_cast<std::size_t>(c)].size();
    EXPECT_EQ(faces, region.faces.size()) << "whole parts";
    EXPECT_EQ(region.name, name_of_parts(parts));
    const SurfacePatch patch = make_patch(prepared, region.faces, 600, test::kTolerance, RunContext{}, "sound");
    const GroupPlacement& placement = region.placement;
    const double tolerance = placement.group.continuous() ? continuous_tolerance(patch) : patch.tolerance;
    EXPECT_TRUE(passes(verify(patch, judged_motions(placement.group, placement.frame, placement.centre), tolerance, 0,
                              0, RunContext{}),
                       {.joint = 0.93, .worst = 0.94, .cluster = 0.02, .part = 0.4}))
        << placement.group.symbol() << " on " << region.name;
  }
}

const FoundRegion* region_of(const PartRegions& found, const std::string& symbol, const std::vector<int>& faces) {
  for (const FoundRegion& region : found.regions) {
    if (region.placement.group.symbol() == symbol && region.faces == faces) return &region;
  }
  return nullptr;
}

std::vector<int> faces_of(const PreparedMesh& prepared, const std::vector<int>& parts) {
  std::vector<int> faces;
  for (const int c : parts) {
    const std::vector<int>& part = prepared.components.faces[static_cast<std::size_t>(c)];
    faces.insert(faces.end(), part.begin(), part.end());
  }
  std::ranges::sort(faces);
  return faces;
}

std::string parts_summary(const PartRegions& found) {
  std::string text;
  for (const FoundRegion& region : found.regions) text += region.placement.group.symbol() + " on " + region.name + "; ";
  return text;
}

class SetsOfParts : public testing::TestWithParam<const char*> {
 protected:
  // Bodies permuted by a group and by no larger one, and a larger body that has no part in it, the last.
  PreparedMesh mesh() {
    Random random(1, GetParam());
    OrbitOptions options;
    options.subdivisions = 0;
    options.frame = random.rotation();
    const GeneratedModel orbit = generate_orbit(*PointGroup::parse(GetParam()), options);
    frame_ = options.frame;
    Mesh aside = test::scalene();
    aside.vertices *= 1.7;
    return prepare(test::joined({orbit.mesh, test::moved(aside, {random.rotation(), 1.9 * random.direction()})}));
  }

  GroupPlacement truth(const PreparedMesh& prepared) const {
    return test::normalised(prepared, {*PointGroup::parse(GetParam()), frame_, Vector3d::Zero()});
  }

  GroupFrame frame_;
};

TEST_P(SetsOfParts, HaveTheGroupThatPermutesThem) {
  const PreparedMesh prepared = mesh();
  const PartRegions found = regions_of(prepared);
  expect_sound(prepared, found);
  std::vector<int> faces = test::all_faces(prepared.mesh);
  faces.resize(faces.size() - 4);
  const FoundRegion* region = region_of(found, GetParam(), faces);
  ASSERT_NE(region, nullptr) << parts_summary(found);
  EXPECT_LT(test::apart(test::motions_of(region->placement), test::motions_of(truth(prepared))), 2e-3);
}

TEST_P(SetsOfParts, WhatIsKnownIsNotSaidAgain) {
  const PreparedMesh prepared = mesh();
  std::vector<int> faces = test::all_faces(prepared.mesh);
  faces.resize(faces.size() - 4);
  const FoundRegion known{truth(prepared), faces, surface_moments(prepared, faces).area, "known"};
  const PartRegions found = regions_of(prepared, {known});
  for (const FoundRegion& region : found.regions) {
    const SurfaceMoments moments = surface_moments(prepared, region.faces);
    EXPECT_FALSE(std::ranges::includes(known.faces, region.faces) &&
                 contains_group(known.placement, region.placement, moments.centroid, moments.radius, 1e-3))
        << region.placement.group.symbol() << " on " << region.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Groups, SetsOfParts,
                         testing::Values("C3", "C5", "C4v", "C3h", "D3", "D2d", "D3d", "S4", "S6", "D2h", "T"));

TEST(PartRegions, APlateItsBoltsAndWhatTheyHaveInCommon) {
  // A square plate, five bolts around one axis and three around another, none of them the plate's.
  std::vector<Mesh> parts{test::box(4, 4, 0.2)};
  const auto ring = [&](int n, const Mesh& bolt, double x) {
    for (int i = 0; i < n; ++i) {
      const Mesh turned = test::moved(bolt, Motion::rotation({0, 0, 1}, 2 * std::numbers::pi * i / n, {0, 0, 0}));
      parts.push_back(test::moved(turned, test::shift(x, 0.35, 0)));
    }
  };
  ring(5, test::moved(test::box(0.2, 0.3, 0.4), test::shift(0.8, 0, 0.3)), -0.9);
  ring(3, test::moved(test::box(0.25, 0.2, 0.6), test::shift(0.5, 0, 0.4)), 1.1);
  const PreparedMesh prepared = prepare(test::joined(parts));
  const PartRegions found = regions_of(prepared);
  expect_sound(prepared, found);
  EXPECT_NE(region_of(found, "D5h", faces_of(prepared, {1, 2, 3, 4, 5})), nullptr) << parts_summary(found);
  EXPECT_NE(region_of(found, "D3h", faces_of(prepared, {6, 7, 8})), nullptr) << parts_summary(found);
  EXPECT_NE(region_of(found, "D4h", faces_of(prepared, {0})), nullptr) << parts_summary(found);
}

TEST(PartRegions, ASubgroupOnMoreParts) {
  const Mesh block = test::box(0.3, 0.2, 0.4);
  const PreparedMesh prepared = prepare(test::joined(
      {test::box(2, 2, 0.1), test::moved(block, test::shift(0.6, 0, 0.3)),
       test::moved(block, test::shift(-0.6, 0, 0.3)), test::moved(test::scalene(), test::shift(0.2, 2.1, 0.4))}));
  const PartRegions found = regions_of(prepared);
  expect_sound(prepared, found);
  EXPECT_NE(region_of(found, "D4h", faces_of(prepared, {0})), nullptr) << parts_summary(found);
  EXPECT_NE(region_of(found, "C2v", faces_of(prepared, {0, 1, 2})), nullptr) << parts_summary(found);
}

TEST(PartRegions, OwnGroupsAreThoseOfTheClasses) {
  const PreparedMesh prepared =
      prepare(test::joined({test::prism(6, 1, 0.8), test::moved(test::scalene(), test::shift(2.3, 0.4, 0)),
                            test::moved(test::prism(6, 1, 0.8), {axis_rotation({1, 0, 0}, 0.7), {0, 3, 1}})}));
  const PartRegions found = regions_of(prepared);
  ASSERT_EQ(found.own_groups.size(), found.survey.classes.size());
  for (std::size_t c = 0; c < found.own_groups.size(); ++c) {
    if (found.survey.classes[c].members.size() == 1) {
      EXPECT_FALSE(found.own_groups[c].has_value());
    } else {
      ASSERT_TRUE(found.own_groups[c].has_value());
      EXPECT_EQ(found.own_groups[c]->group.symbol(), "D6h");
    }
  }
}

TEST(PartRegions, NothingAmongPartsWithoutSymmetry) {
  Mesh larger = test::scalene();
  larger.vertices.col(0) *= 1.8;
  Mesh other = test::scalene();
  other.vertices.col(2) *= 2.3;
  const PreparedMesh prepared = prepare(test::joined(
      {test::scalene(), test::moved(larger, test::shift(0, 2, 0)), test::moved(other, test::shift(2, 1, 1))}));
  EXPECT_TRUE(regions_of(prepared).regions.empty());
}

TEST(PartRegions, StopsWhenItIsLate) {
  const PreparedMesh prepared =
      prepare(test::joined({test::box(1, 1, 1), test::moved(test::box(1, 2, 3), test::shift(3, 0.3, 0.2))}));
  PartRegionOptions options;
  options.late = [] { return true; };
  const PartRegions found = regions_of(prepared, {}, options);
  EXPECT_TRUE(found.regions.empty());
  EXPECT_EQ(found.own_groups.size(), found.survey.classes.size());
}

// One surface: an L-shaped bracket, which has a mirror only, with nothing turned on it.
Mesh bracket() {
  Mesh mesh;
  mesh.vertices.resize(12, 3);
  mesh.vertices << 0, 0, 0, 2, 0, 0, 2, 0.5, 0, 0.4, 0.5, 0, 0.4, 1.7, 0, 0, 1.7, 0, 0, 0, 1, 2, 0, 1, 2, 0.5, 1, 0.4,
      0.5, 1, 0.4, 1.7, 1, 0, 1.7, 1;
  mesh.faces.resize(20, 3);
  mesh.faces << 0, 2, 1, 0, 3, 2, 0, 4, 3, 0, 5, 4, 6, 7, 8, 6, 8, 9, 6, 9, 10, 6, 10, 11, 0, 1, 7, 0, 7, 6, 1, 2, 8, 1,
      8, 7, 2, 3, 9, 2, 9, 8, 3, 4, 10, 3, 10, 9, 4, 5, 11, 4, 11, 10, 5, 0, 6, 5, 6, 11;
  return mesh;
}

TEST(PartRegions, OfPiecesTheBordersAloneMakeNoGroup) {
  PreparedMesh prepared = prepare(bracket());
  prepared.components = smooth_segments(prepared);
  ASSERT_EQ(prepared.components.faces.size(), 8U);
  PartRegionOptions options;
  options.pieces = true;
  Explanation explanation;
  options.explanation = &explanation;
  const PartRegions found = regions_of(prepared, {}, options);
  expect_sound(prepared, found);
  for (const FoundRegion& region : found.regions) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(surface_moments(prepared, region.faces).covariance);
    EXPECT_GT(solver.eigenvalues()[0], 1e-6) << "flat: " << region.name;
  }
  // As parts of their own the same rectangles have groups.
  const PartRegions parts = regions_of(prepared);
  const auto flat = [&](const FoundRegion& region) { return region.faces.size() == 2; };
  EXPECT_GT(std::ranges::count_if(parts.regions, flat), 0);
  EXPECT_EQ(std::ranges::count_if(found.regions, flat), 0);
}

TEST(PartRegions, WhatIsKeptIsNoted) {
  std::vector<Mesh> parts{test::box(4, 4, 0.2)};
  for (int i = 0; i < 3; ++i) {
    const Mesh bolt = test::moved(test::box(0.2, 0.3, 0.4), test::shift(0.8, 0, 0.3));
    const Mesh turned = test::moved(bolt, Motion::rotation({0, 0, 1}, 2 * std::numbers::pi * i / 3, {0, 0, 0}));
    parts.push_back(test::moved(turned, test::shift(0.3, 0.35, 0)));
  }
  const PreparedMesh prepared = prepare(test::joined(parts));
  PartRegionOptions options;
  Explanation explanation;
  options.explanation = &explanation;
  const PartRegions found = regions_of(prepared, {}, options);
  ASSERT_FALSE(found.regions.empty());
  for (const FoundRegion& region : found.regions) {
    const std::string subject = region.placement.group.symbol() + " on " + region.name;
    EXPECT_TRUE(std::ranges::any_of(explanation.notes, [&](const Explanation::Note& note) {
      return note.kept && note.subject == subject && !note.stage.empty() && !note.reason.empty();
    })) << subject;
  }
  const auto kept = std::ranges::count_if(explanation.notes, &Explanation::Note::kept);
  EXPECT_EQ(static_cast<std::size_t>(kept), found.regions.size()) << "and nothing else";
}

TEST(NameOfParts, GivesRunsAndStopsInTime) {
  EXPECT_EQ(name_of_parts({3}), "part 3");
  EXPECT_EQ(name_of_parts({1, 4, 5, 6, 7}), "parts 1, 4-7");
  EXPECT_EQ(name_of_parts({0, 1}), "parts 0-1");
  std::vector<int> many;
  for (int i = 0; i < 100; ++i) many.push_back(3 * i);
  const std::string name = name_of_parts(many);
  EXPECT_LT(name.size(), 80U);
  EXPECT_TRUE(name.ends_with(", ..."));
}

// A row of equal scalene blocks on a rail, so that each has a mirror of its own and so has any few of them.
class Row : public testing::TestWithParam<int> {};

TEST_P(Row, IsNamedOnceNotByItsPieces) {
  const int count = GetParam();
  std::vector<Mesh> parts{test::box(count + 1.0, 0.4, 0.2)};
  for (int i = 0; i < count; ++i) {
    parts.push_back(test::moved(test::box(0.3, 0.5, 0.9), test::shift(i - 0.5 * (count - 1), 0.1, 0.3)));
  }
  const PreparedMesh prepared = prepare(test::joined(parts));
  const PartRegions found = regions_of(prepared);
  expect_sound(prepared, found);
  const std::size_t block = prepared.components.faces[1].size();
  for (const FoundRegion& region : found.regions) {
    const bool some = region.faces.size() > block && region.faces.size() < static_cast<std::size_t>(count) * block;
    EXPECT_FALSE(some) << region.placement.group.symbol() << " on " << region.name;
  }
  EXPECT_TRUE(std::ranges::any_of(found.regions, [&](const FoundRegion& region) {
    return region.faces.size() == static_cast<std::size_t>(count + 1) * block;
  }));
}

INSTANTIATE_TEST_SUITE_P(Blocks, Row, testing::Values(5, 6, 9));

}  // namespace
}  // namespace orbifit

#include "domains/closed_sets.h"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "orbifit/model/point_group.h"

#include "consistency/consistency_closure.h"
#include "domains/domain_map.h"

namespace orbifit {
namespace {

using Eigen::Vector3d;

constexpr int kCells = 8;  // along x and along y

// A square plate from -1 to 1 of kCells by kCells squares, with a ridge along y so that no mirror is one of height.
Mesh plate() {
  Mesh mesh;
  mesh.vertices.resize((kCells + 1) * (kCells + 1), 3);
  for (int i = 0; i <= kCells; ++i) {
    for (int j = 0; j <= kCells; ++j) {
      const double x = 2.0 * i / kCells - 1;
      const double y = 2.0 * j / kCells - 1;
      mesh.vertices.row(i * (kCells + 1) + j) << x, y, 0.3 * x * x;
    }
  }
  mesh.faces.resize(2 * kCells * kCells, 3);
  for (int i = 0; i < kCells; ++i) {
    for (int j = 0; j < kCells; ++j) {
      const int corner = i * (kCells + 1) + j;
      const int face = 2 * (i * kCells + j);
      mesh.faces.row(face) << corner, corner + kCells + 1, corner + 1;
      mesh.faces.row(face + 1) << corner + 1, corner + kCells + 1, corner + kCells + 2;
    }
  }
  return mesh;
}

// The squares from (i0, j0) up to but without (i1, j1), mirrored in their middle's y.
Region patch(int id, int i0, int j0, int i1, int j1) {
  std::vector<int> faces;
  for (int i = i0; i < i1; ++i) {
    for (int j = j0; j < j1; ++j) {
      faces.push_back(2 * (i * kCells + j));
      faces.push_back(2 * (i * kCells + j) + 1);
    }
  }
  const double middle = (j0 + j1) / double{kCells} - 1;
  Region region = make_region(*PointGroup::parse("Cs"), Vector3d(0, middle, 0), frame_about(Vector3d::UnitY()), faces,
                              "patch " + std::to_string(id));
  region.id = id;
  return region;
}

Disagreements of(const std::vector<Region>& regions) {
  SymmetryAnnotation annotation;
  annotation.regions = regions;
  return disagreements(plate(), annotation, RunContext{});
}

void expect_only(const Disagreements& found, std::size_t a, std::size_t b) {
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found.begin()->first, (std::pair{Claim{false, a}, Claim{false, b}}));
}

TEST(Disagreements, AreNoneOfRegionsThatAreApart) {
  EXPECT_TRUE(of({patch(0, 0, 0, 3, 8), patch(1, 5, 0, 8, 4)}).empty());
}

TEST(Disagreements, AreNoneOfNestedOnesOfOneMirror) {
  EXPECT_TRUE(of({patch(0, 0, 0, 8, 8), patch(1, 2, 2, 4, 6)}).empty());
}

// The mirror of the first takes the border of both to where the first is alone.
TEST(Disagreements, AreOfWhatTouchesWithoutAnImage) {
  expect_only(of({patch(0, 0, 0, 4, 8), patch(1, 4, 0, 8, 4)}), 0, 1);
}

TEST(Disagreements, AreNoneOfWhatTouchesAndHasAnImage) {
  EXPECT_TRUE(of({patch(0, 0, 0, 4, 8), patch(1, 4, 1, 8, 3), patch(2, 4, 5, 8, 7)}).empty());
}

TEST(Disagreements, AreOfAChildWithoutAnImage) {
  expect_only(of({patch(0, 0, 0, 8, 8), patch(1, 2, 1, 4, 3)}), 0, 1);
}

TEST(Disagreements, AreNoneOfChildrenThatAreImages) {
  EXPECT_TRUE(of({patch(0, 0, 0, 8, 8), patch(1, 2, 1, 4, 3), patch(2, 2, 5, 4, 7)}).empty());
}

// A step takes the border of two copies to the end of the row.
TEST(Disagreements, AreOfCopiesThatTouch) {
  SymmetryAnnotation annotation;
  Pattern pattern;
  pattern.kind = Pattern::Kind::congruent;
  pattern.instances = {{Motion{}, patch(0, 0, 0, 3, 4).faces},
                       {Motion{Eigen::Matrix3d::Identity(), Vector3d(0, 1, 0)}, patch(0, 0, 4, 3, 8).faces}};
  annotation.patterns = {pattern};
  const Disagreements found = disagreements(plate(), annotation, RunContext{});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found.begin()->first, (std::pair{Claim{true, 0}, Claim{true, 0}}));
}

// Two copies of which one has a region within.
TEST(Disagreements, AreOfAPatternAndWhatOneInstanceHolds) {
  SymmetryAnnotation annotation;
  annotation.regions = {patch(0, 0, 1, 2, 3)};
  Pattern pattern;
  pattern.kind = Pattern::Kind::congruent;
  pattern.instances = {{Motion{}, patch(0, 0, 0, 3, 3).faces},
                       {Motion{Eigen::Matrix3d::Identity(), Vector3d(0, 1, 0)}, patch(0, 0, 4, 3, 7).faces}};
  annotation.patterns = {pattern};
  const Disagreements found = disagreements(plate(), annotation, RunContext{});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found.begin()->first, (std::pair{Claim{false, 0}, Claim{true, 0}}));
  annotation.regions.push_back(patch(1, 0, 5, 2, 7));
  EXPECT_TRUE(disagreements(plate(), annotation, RunContext{}).empty());
}

// Of three copies one lies outside of a region that mirrors each of the others into itself: what holds an instance need
// not come along with it, as long as it is around all of it.
TEST(Disagreements, AreNoneOfAPatternThatARegionHoldsInPart) {
  SymmetryAnnotation annotation;
  annotation.regions = {patch(0, 3, 0, 8, 8)};
  Pattern pattern;
  pattern.kind = Pattern::Kind::congruent;
  for (const int i : {0, 3, 6}) {
    pattern.instances.push_back(
        {Motion{Eigen::Matrix3d::Identity(), Vector3d(2.0 * i / kCells, 0, 0)}, patch(0, i, 3, i + 2, 5).faces});
  }
  annotation.patterns = {pattern};
  EXPECT_TRUE(disagreements(plate(), annotation, RunContext{}).empty());
  // Not so where the region turns, since points on a circle would have one orbit here and another there.
  annotation.regions[0] = make_region(*PointGroup::parse("Cinfv"), Vector3d::Zero(), frame_about(Vector3d::UnitY()),
                                      annotation.regions[0].faces, "turned");
  EXPECT_FALSE(disagreements(plate(), annotation, RunContext{}).empty());
  // Nor where the region ends within an instance.
  annotation.regions = {patch(0, 4, 0, 8, 8)};
  EXPECT_FALSE(disagreements(plate(), annotation, RunContext{}).empty());
}

// What the mirror around takes to one another is one family, and so is what lies on the instances of a pattern.
TEST(Disagreements, TellWhatStandsOrFallsTogether) {
  SymmetryAnnotation annotation;
  annotation.regions = {patch(0, 0, 0, 8, 8), patch(1, 2, 1, 4, 3), patch(2, 2, 5, 4, 7)};
  std::vector<ClaimFamily> families;
  EXPECT_TRUE(disagreements(plate(), annotation, RunContext{}, &families).empty());
  EXPECT_EQ(families, (std::vector<ClaimFamily>{{{false, 0}}, {{false, 1}, {false, 2}}}));
  Pattern pattern;
  pattern.kind = Pattern::Kind::congruent;
  pattern.instances = {{Motion{}, patch(0, 1, 0, 5, 3).faces},
                       {Motion{Eigen::Matrix3d::Identity(), Vector3d(0, 1, 0)}, patch(0, 1, 4, 5, 7).faces}};
  annotation.regions.erase(annotation.regions.begin());
  annotation.patterns = {pattern};
  disagreements(plate(), annotation, RunContext{}, &families);
  EXPECT_EQ(families, (std::vector<ClaimFamily>{{{false, 0}, {false, 1}}, {{true, 0}}}));
}

// Two patches that are images of one another save more than what overlaps both of them, one alone would not.
TEST(Disagreements, AreSettledForAWholeFamily) {
  SymmetryAnnotation annotation;
  annotation.regions = {patch(0, 0, 0, 8, 8), patch(1, 0, 1, 4, 3), patch(2, 0, 5, 4, 7), patch(3, 0, 2, 3, 6)};
  ConsistentAnnotation kept{annotation, {}, 0, 0};
  const Mesh mesh = plate();
  KnownDomains domains(mesh);
  leave_out_disagreements(mesh, domains, annotation, kept, RunContext{});
  ASSERT_EQ(kept.left_out.size(), 1U);
  EXPECT_EQ(kept.left_out[0].id, 3);
  EXPECT_EQ(kept.annotation.regions.size(), 3U);
}

// Two mirrors of one patch: sets of places go to sets, but points do not come back where no whole number of the angles
// makes a turn.
class UnclosedGroups : public testing::TestWithParam<double> {};

TEST_P(UnclosedGroups, AreNamedAndTheLesserLeftOut) {
  Region first = patch(0, 1, 1, 7, 7);
  Region second =
      make_region(first.group, first.centre, frame_about(Vector3d(std::sin(GetParam()), std::cos(GetParam()), 0)),
                  patch(1, 1, 2, 7, 6).faces, "turned");
  second.id = 1;
  SymmetryAnnotation annotation;
  annotation.regions = {first, second};
  const bool closes = std::abs(std::remainder(GetParam(), std::numbers::pi / 6)) < 1e-9;
  const Mesh mesh = plate();
  KnownDomains domains(mesh);
  const Disagreements found = unclosed_groups(domains.of(annotation), annotation, RunContext{});
  if (!closes) expect_only(found, 0, 1);
  EXPECT_EQ(found.empty(), closes);
  ConsistentAnnotation kept{annotation, {}, 0, 0};
  EXPECT_EQ(leave_out_unclosed(mesh, domains, annotation, kept, RunContext{}), !closes);
  ASSERT_EQ(kept.annotation.regions.size(), closes ? 2U : 1U);
  EXPECT_EQ(kept.annotation.regions.front().id, 0);
  EXPECT_EQ(kept.left_out.size(), closes ? 0U : 1U);
}

INSTANTIATE_TEST_SUITE_P(Angles, UnclosedGroups,
                         testing::Values(0.0, std::numbers::pi / 6, std::numbers::pi / 2, 0.04, 0.7));

// What holds everything stays where it is: it is not the image of what holds but one of the copies as well.
TEST(DomainMap, GivesEachPlaceOneImage) {
  SymmetryAnnotation annotation;
  annotation.regions = {patch(0, 0, 0, 8, 8), patch(1, 3, 3, 5, 5)};
  Pattern pattern;
  pattern.kind = Pattern::Kind::congruent;
  for (const int i : {0, 3}) {
    pattern.instances.push_back(
        {Motion{Eigen::Matrix3d::Identity(), Vector3d(2.0 * i / kCells, 0, 0)}, patch(0, i, 3, i + 2, 5).faces});
  }
  annotation.patterns = {pattern};
  const DomainMap domains(plate(), annotation, instance_motions(annotation));
  const int second = domains.first_place_of_pattern(0) + 1;
  EXPECT_EQ(domains.images_of(0, second, 0), std::vector<int>{0});
  EXPECT_TRUE(domains.images_of(1, second, 0).empty());
}

}  // namespace
}  // namespace orbifit

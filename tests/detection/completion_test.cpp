#include "search/completion.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "base/random.h"
#include "placements.h"
#include "shapes.h"

namespace orbifit {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kExact = 1e-12;  // of the diagonal

// Boxes at all images of one place under a group, each with its D2h, and the group on all of them.
struct Assembly {
  PreparedMesh prepared;
  std::vector<FoundRegion> regions;  // the whole first, then the boxes
  std::vector<Motion> group;         // of the whole
};

FoundRegion region_on(const PreparedMesh& prepared, const GroupPlacement& placement, std::vector<int> faces,
                      const std::string& name) {
  const double area = surface_moments(prepared, faces).area;
  return {test::normalised(prepared, placement), std::move(faces), area, name};
}

// \param first the pose of the first box; boxes that coincide are one
Assembly assembly(const PointGroup& group, const GroupFrame& frame, const Motion& first, const Vector3d& size) {
  std::vector<Mesh> parts;
  std::vector<GroupPlacement> placements;
  for (const Matrix3d& linear : elements(group, frame)) {
    const Motion motion = Motion{linear, Vector3d::Zero()};
    const GroupPlacement placement = carried({*PointGroup::parse("D2h"), first.linear, first.translation}, motion);
    const bool repeated = std::ranges::any_of(
        placements, [&](const GroupPlacement& other) { return (other.centre - placement.centre).norm() < 1e-6; });
    if (repeated) continue;
    placements.push_back(placement);
    parts.push_back(test::moved(test::box(size[0], size[1], size[2]), motion * first));
  }
  const Mesh mesh = test::joined(parts);
  Assembly result{prepare(mesh), {}, {}};
  result.regions.push_back(
      region_on(result.prepared, {group, frame, Vector3d::Zero()}, test::all_faces(mesh), "whole"));
  for (std::size_t i = 0; i < parts.size(); ++i) {
    result.regions.push_back(
        region_on(result.prepared, placements[i], result.prepared.components.faces[i], "box " + std::to_string(i)));
  }
  result.group = test::motions_of(result.regions.front().placement);
  return result;
}

// A little off its place, as a detector finds it.
void shake(GroupPlacement& placement, Random& random) {
  placement.frame = axis_rotation(random.direction(), 2e-4) * placement.frame;
  placement.centre += 1e-4 * random.direction();
}

const FoundRegion* on_faces(const std::vector<FoundRegion>& regions, const std::vector<int>& faces) {
  const auto found = std::ranges::find(regions, faces, &FoundRegion::faces);
  return found == regions.end() ? nullptr : &*found;
}

// Every element of the whole carries every region's group to that of the region on the image.
void expect_exactly_carried(const Assembly& made, const std::vector<FoundRegion>& regions) {
  for (const FoundRegion& region : regions) {
    if (region.name == "whole") continue;
    for (const Motion& motion : made.group) {
      const std::vector<Motion> goal = test::conjugated(motion, test::motions_of(region.placement));
      double least = 1e300;
      for (const FoundRegion& other : regions) {
        if (other.name == "whole") continue;
        least = std::min(least, test::apart(goal, test::motions_of(other.placement)));
      }
      EXPECT_LT(least, kExact) << region.name;
    }
  }
}

class Carried : public testing::TestWithParam<const char*> {};

TEST_P(Carried, IsTheConjugateGroup) {
  Random random(1, GetParam());
  for (int trial = 0; trial < 10; ++trial) {
    const GroupPlacement placement{*PointGroup::parse(GetParam()), random.rotation(), random.direction()};
    Motion motion{random.rotation(), random.direction()};
    if (trial % 2 == 1) motion = motion * Motion::reflection(random.direction(), Vector3d::Zero());
    const GroupPlacement image = carried(placement, motion);
    EXPECT_EQ(image.group, placement.group);
    EXPECT_NEAR(image.frame.determinant(), 1, 1e-12);
    EXPECT_LT(orthogonality_error(image.frame), 1e-12);
    EXPECT_LT(test::apart(test::motions_of(image), test::conjugated(motion, test::motions_of(placement))), kExact);
  }
}

INSTANTIATE_TEST_SUITE_P(Groups, Carried,
                         testing::Values("Cs", "Ci", "C2", "C3", "C5", "C2v", "C3v", "C4v", "C3h", "C4h", "D2", "D3",
                                         "D5", "D2h", "D3h", "D6h", "D2d", "D3d", "D4d", "S4", "S6", "T", "Td", "Th",
                                         "O", "Oh", "I", "Ih"));

class Completed : public testing::TestWithParam<const char*> {
 protected:
  Assembly made() const {
    Random random(2, GetParam());
    // In general position: no element of any of the groups leaves the box in place.
    const Motion first{axis_rotation(Vector3d(1, 2, 3).normalized(), 0.6), Vector3d(0.95, 0.33, 0.62)};
    const GroupFrame frame = random.rotation();
    return assembly(*PointGroup::parse(GetParam()), frame, Motion{frame, Vector3d::Zero()} * first, {0.08, 0.12, 0.17});
  }
};

TEST_P(Completed, ARegionThatWasMissedComesBackExactlyCarried) {
  const Assembly truth = made();
  const std::size_t count = truth.regions.size();
  for (const std::size_t missed : {std::size_t{1}, count / 2, count - 1}) {
    Random random(missed, GetParam());
    std::vector<FoundRegion> regions = truth.regions;
    for (std::size_t r = 1; r < count; ++r) shake(regions[r].placement, random);
    const std::vector<int> faces = regions[missed].faces;
    regions.erase(regions.begin() + static_cast<std::ptrdiff_t>(missed));
    Explanation explanation;
    complete_regions(truth.prepared, SurfaceIndex(truth.prepared.mesh), {test::kTolerance, 300, &explanation},
                     RunContext{}, regions);
    ASSERT_EQ(regions.size(), count);
    const FoundRegion* back = on_faces(regions, faces);
    ASSERT_NE(back, nullptr) << "on the very same faces";
    EXPECT_NEAR(back->area, truth.regions[missed].area, 1e-12);
    EXPECT_EQ(back->placement.group.symbol(), "D2h");
    EXPECT_LT(test::apart(test::motions_of(back->placement), test::motions_of(truth.regions[missed].placement)), 2e-3);
    expect_exactly_carried(truth, regions);
    EXPECT_EQ(std::ranges::count_if(explanation.notes, &Explanation::Note::kept), 1);
  }
}

TEST_P(Completed, OneRegionIsEnough) {
  const Assembly truth = made();
  std::vector<FoundRegion> regions{truth.regions[0], truth.regions[1]};
  complete_regions(truth.prepared, SurfaceIndex(truth.prepared.mesh), {test::kTolerance}, RunContext{}, regions);
  ASSERT_EQ(regions.size(), truth.regions.size());
  for (const FoundRegion& region : truth.regions) EXPECT_NE(on_faces(regions, region.faces), nullptr);
  expect_exactly_carried(truth, regions);
}

TEST_P(Completed, TwiceIsOnce) {
  const Assembly truth = made();
  std::vector<FoundRegion> once{truth.regions[0], truth.regions[1]};
  complete_regions(truth.prepared, SurfaceIndex(truth.prepared.mesh), {test::kTolerance}, RunContext{}, once);
  std::vector<FoundRegion> twice = once;
  complete_regions(truth.prepared, SurfaceIndex(truth.prepared.mesh), {test::kTolerance}, RunContext{}, twice);
  ASSERT_EQ(twice.size(), once.size());
  for (const FoundRegion& region : once) {
    const FoundRegion* same = on_faces(twice, region.faces);
    ASSERT_NE(same, nullptr);
    EXPECT_LT(test::apart(test::motions_of(same->placement), test::motions_of(region.placement)), kExact);
  }
}

TEST_P(Completed, NothingOnceTimeIsUp) {
  const Assembly truth = made();
  std::vector<FoundRegion> regions{truth.regions[0], truth.regions[1]};
  CompletionOptions options{test::kTolerance};
  int asked = 0;
  options.late = [&] { return ++asked > 1; };
  complete_regions(truth.prepared, SurfaceIndex(truth.prepared.mesh), options, RunContext{}, regions);
  EXPECT_EQ(regions.size(), 2U);
  EXPECT_GT(asked, 1);
}

TEST_P(Completed, SameForAnyNumberOfThreads) {
  const Assembly truth = made();
  std::vector<FoundRegion> one{truth.regions[0], truth.regions[1]};
  std::vector<FoundRegion> several = one;
  RunContext context;
  complete_regions(truth.prepared, SurfaceIndex(truth.prepared.mesh), {test::kTolerance}, context, one);
  context.threads = 3;
  complete_regions(truth.prepared, SurfaceIndex(truth.prepared.mesh), {test::kTolerance}, context, several);
  ASSERT_EQ(one.size(), several.size());
  for (std::size_t r = 0; r < one.size(); ++r) {
    EXPECT_EQ(one[r].faces, several[r].faces);
    EXPECT_EQ(one[r].placement.frame, several[r].placement.frame);
    EXPECT_EQ(one[r].placement.centre, several[r].placement.centre);
  }
}

TEST_P(Completed, NoMoreThanAskedFor) {
  const Assembly truth = made();
  std::vector<FoundRegion> regions{truth.regions[0], truth.regions[1]};
  complete_regions(truth.prepared, SurfaceIndex(truth.prepared.mesh), {test::kTolerance, 2}, RunContext{}, regions);
  EXPECT_EQ(regions.size(), 2U);
}

INSTANTIATE_TEST_SUITE_P(Groups, Completed,
                         testing::Values("Cs", "Ci", "C2", "C3", "C4", "C5", "C4v", "C2h", "D3", "D2d", "D3d", "S4",
                                         "T", "Td", "Oh"));

class LeftInPlace : public testing::TestWithParam<int> {};

TEST_P(LeftInPlace, ByTheElementsThatKeepTheRegion) {
  const int n = GetParam();
  Random random(5, std::to_string(n));
  // Boxes upright on the twofold axes of Dnh, each of which keeps the box at it.
  const GroupFrame frame = random.rotation();
  const Assembly truth =
      assembly({PointGroup::Family::Dnh, n}, frame, {frame, frame * Vector3d(1, 0, 0)}, {0.2, 0.3, 0.4});
  std::vector<FoundRegion> regions = truth.regions;
  for (std::size_t r = 1; r < regions.size(); ++r) shake(regions[r].placement, random);
  complete_regions(truth.prepared, SurfaceIndex(truth.prepared.mesh), {test::kTolerance}, RunContext{}, regions);
  EXPECT_EQ(regions.size(), truth.regions.size());
  for (const FoundRegion& region : regions) {
    if (region.name == "whole") continue;
    for (const Motion& motion : truth.group) {
      const Vector3d centroid = surface_moments(truth.prepared, region.faces).centroid;
      if ((motion(centroid) - centroid).norm() > 0.05) continue;
      const std::vector<Motion> own = test::motions_of(region.placement);
      EXPECT_LT(test::apart(test::conjugated(motion, own), own), kExact) << region.name;
    }
  }
  expect_exactly_carried(truth, regions);
}

INSTANTIATE_TEST_SUITE_P(Orders, LeftInPlace, testing::Values(2, 3, 4, 5, 8));

// A square table: a top, and four legs turned about their own axes.
class Table : public testing::Test {
 protected:
  static Mesh leg(int i, double length) {
    const Mesh upright = test::moved(test::prism(5, 0.15, length), test::shift(0.8, 0.8, -length / 2));
    return test::moved(upright, Motion::rotation({0, 0, 1}, i * std::numbers::pi / 2, {0, 0, 0}));
  }

  static std::vector<FoundRegion> regions_of(const PreparedMesh& prepared, int legs) {
    std::vector<FoundRegion> regions{region_on(prepared, {*PointGroup::parse("C4"), GroupFrame::Identity(), {0, 0, 0}},
                                               test::all_faces(prepared.mesh), "whole")};
    for (int i = 0; i < legs; ++i) {
      const Motion turn = Motion::rotation({0, 0, 1}, i * std::numbers::pi / 2, {0, 0, 0});
      // The prism's first corner is on its x axis: a twofold axis of D5h.
      regions.push_back(
          region_on(prepared, carried({*PointGroup::parse("D5h"), GroupFrame::Identity(), {0.8, 0.8, -0.5}}, turn),
                    prepared.components.faces[static_cast<std::size_t>(i) + 1], "leg " + std::to_string(i)));
    }
    return regions;
  }
};

TEST_F(Table, GetsTheRegionOfItsFourthLegBack) {
  const PreparedMesh prepared =
      prepare(test::joined({test::box(2, 2, 0.1), leg(0, 1), leg(1, 1), leg(2, 1), leg(3, 1)}));
  std::vector<FoundRegion> regions = regions_of(prepared, 3);
  complete_regions(prepared, SurfaceIndex(prepared.mesh), {test::kTolerance}, RunContext{}, regions);
  ASSERT_EQ(regions.size(), 5U);
  EXPECT_EQ(regions.back().faces, prepared.components.faces[4]);
  const std::vector<FoundRegion> truth = regions_of(prepared, 4);
  EXPECT_LT(test::apart(test::motions_of(regions.back().placement), test::motions_of(truth.back().placement)), kExact);
}

TEST_F(Table, GetsNoneWhereTheLegIsMissingOrAnother) {
  // The whole's group is wrong on these; what is not there is not made up.
  for (const auto& parts : {std::vector<Mesh>{test::box(2, 2, 0.1), leg(0, 1), leg(1, 1), leg(2, 1)},
                            std::vector<Mesh>{test::box(2, 2, 0.1), leg(0, 1), leg(1, 1), leg(2, 1), leg(3, 0.7)}}) {
    const PreparedMesh prepared = prepare(test::joined(parts));
    std::vector<FoundRegion> regions = regions_of(prepared, 3);
    complete_regions(prepared, SurfaceIndex(prepared.mesh), {test::kTolerance}, RunContext{}, regions);
    EXPECT_EQ(regions.size(), 4U);
  }
}

TEST_F(Table, CarriesContinuousGroupsButIsCarriedByNone) {
  std::vector<Mesh> parts{test::box(2, 2, 0.1)};
  for (int i = 0; i < 4; ++i) {
    const Mesh upright = test::moved(test::prism(64, 0.15, 1), test::shift(0.8, 0.8, -0.5));
    parts.push_back(test::moved(upright, Motion::rotation({0, 0, 1}, i * std::numbers::pi / 2, {0, 0, 0})));
  }
  const PreparedMesh prepared = prepare(test::joined(parts));
  const auto regions_with = [&](const char* symbol) {
    return std::vector<FoundRegion>{
        region_on(prepared, {*PointGroup::parse(symbol), GroupFrame::Identity(), {0, 0, 0}},
                  test::all_faces(prepared.mesh), "whole"),
        region_on(prepared, {*PointGroup::parse("Dinfh"), GroupFrame::Identity(), {0.8, 0.8, -0.5}},
                  prepared.components.faces[1], "leg")};
  };
  std::vector<FoundRegion> regions = regions_with("C4v");
  complete_regions(prepared, SurfaceIndex(prepared.mesh), {test::kTolerance}, RunContext{}, regions);
  ASSERT_EQ(regions.size(), 5U);
  for (std::size_t r = 1; r < 5; ++r) {
    EXPECT_EQ(regions[r].placement.group.symbol(), "Dinfh");
    const Vector3d centroid = surface_moments(prepared, regions[r].faces).centroid;
    EXPECT_LT((regions[r].placement.centre - centroid).norm(), 1e-9);
    EXPECT_LT(regions[r].placement.frame.col(2).cross(Vector3d::UnitZ()).norm(), kExact);
  }
  std::vector<FoundRegion> others = regions_with("Cinfv");
  complete_regions(prepared, SurfaceIndex(prepared.mesh), {test::kTolerance}, RunContext{}, others);
  EXPECT_EQ(others.size(), 2U);
}

}  // namespace
}  // namespace orbifit

// Regions found on the surface itself: rotations about given axes, mirrors, and what the grid says of a group.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <ostream>
#include <string>

#include <gtest/gtest.h>

#include "group/verification.h"
#include "search/axis_regions.h"
#include "search/generated_groups.h"
#include "search/maximal_subgroups.h"
#include "search/plane_regions.h"
#include "search/revolution_regions.h"
#include "shapes.h"
#include "support/axial_groups.h"
#include "support/own_group.h"
#include "surface/segments.h"

namespace orbifit {
namespace {

using Eigen::Vector3d;

constexpr int kSamples = 6000;

/// A mesh cut into pieces, with its grid.
class Screened {
 public:
  explicit Screened(const Mesh& mesh)
      : prepared_(cut(mesh)), whole_(prepared_.mesh), surface_(prepared_, test::kTolerance, kSamples, {}) {}

  GroupPlacement placement(const std::string& symbol, const Vector3d& centre = Vector3d::Zero()) const {
    const Similarity& input = prepared_.input_of_normalised;
    return {*PointGroup::parse(symbol), GroupFrame::Identity(), (centre - input.translation) / input.scale};
  }

  double share_of(const std::vector<int>& faces) const {
    double area = 0;
    for (const int f : faces) area += prepared_.areas[f];
    return area / prepared_.area;
  }

  std::vector<FoundRegion> turning(const Vector3d& centre = Vector3d::Zero(),
                                   const std::vector<FoundRegion>& known = {}) const {
    const Line axis{placement("C2", centre).centre, Vector3d::UnitZ()};
    return find_axis_regions(surface_, whole_, {axis}, known, {}, {}).regions;
  }

  std::vector<FoundRegion> mirrored() const {
    LineRegionOptions options;
    options.least_share = 0.02;
    return find_plane_regions(surface_, whole_, mirror_planes(surface_, {}, options.least_share, {}), {}, {}, options,
                              {});
  }

  std::vector<FoundRegion> wider(const std::vector<FoundRegion>& known) const {
    return find_wider_subgroups(surface_, whole_, known, {}, known, {}, {});
  }

  const ScreenedSurface& surface() const { return surface_; }
  const SurfaceIndex& whole() const { return whole_; }

 private:
  static PreparedMesh cut(const Mesh& mesh) {
    PreparedMesh prepared = prepare(mesh);
    prepared.components = smooth_segments(prepared);
    return prepared;
  }

  PreparedMesh prepared_;
  SurfaceIndex whole_;
  ScreenedSurface surface_;
};

std::vector<std::string> symbols(const std::vector<FoundRegion>& regions) {
  std::vector<std::string> result;
  for (const FoundRegion& region : regions) result.push_back(region.placement.group.symbol());
  return result;
}

class PrismAbout : public testing::TestWithParam<int> {};

TEST_P(PrismAbout, IsFoundWholeWithItsMirrors) {
  const int n = GetParam();
  const Screened prism(test::prism(n, 1, 1.3));
  const std::vector<FoundRegion> found = prism.turning();
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found.front().placement.group.symbol(), "D" + std::to_string(n) + "h");
  EXPECT_NEAR(prism.share_of(found.front().faces), 1, 1e-9);
}

TEST_P(PrismAbout, SaysNothingThatIsKnown) {
  const int n = GetParam();
  const Screened prism(test::prism(n, 1, 1.3));
  const FoundRegion whole{prism.placement("D" + std::to_string(n) + "h"), prism.surface().faces,
                          prism.surface().prepared.area, "whole"};
  EXPECT_EQ(symbols(prism.turning(Vector3d::Zero(), {whole})), std::vector<std::string>{});
}

INSTANTIATE_TEST_SUITE_P(Orders, PrismAbout, testing::Values(3, 4, 5, 6, 8));

TEST(AxisRegions, LeaveOutWhatDoesNotTurn) {
  // A hexagonal post with a block at its side: the post turns, the block does not.
  const Mesh post = test::prism(6, 1, 4);
  const Mesh block = test::moved(test::box(0.7, 0.4, 0.5), {Eigen::Matrix3d::Identity(), {2.2, 0.3, 0.4}});
  const Screened both(test::joined({post, block}));
  const std::vector<FoundRegion> found = both.turning();
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found.front().placement.group.symbol(), "D6h");
  EXPECT_EQ(found.front().faces.size(), static_cast<std::size_t>(post.faces.rows()));
}

TEST(AxisRegions, HaveMirrorsThatTheWholeHasNot) {
  // A table with its group: the top is its own mirror image across its middle, which its large faces tell of.
  const Mesh top = test::subdivided(test::box(2, 2, 0.3), 4);
  std::vector<Mesh> parts{top};
  for (const double x : {-0.8, 0.8}) {
    for (const double y : {-0.8, 0.8}) {
      parts.push_back(test::moved(test::subdivided(test::box(0.2, 0.2, 1.5), 3), test::shift(x, y, -0.9)));
    }
  }
  const Screened table(test::joined(parts));
  const FoundRegion whole{table.placement("C4v"), table.surface().faces, table.surface().prepared.area, "whole"};
  const std::vector<FoundRegion> found = table.turning(Vector3d::Zero(), {whole});
  const auto of_top =
      std::ranges::find_if(found, [](const FoundRegion& region) { return region.placement.group.symbol() == "D4h"; });
  ASSERT_NE(of_top, found.end());
  EXPECT_EQ(of_top->faces.size(), static_cast<std::size_t>(top.faces.rows()));
}

TEST(AxisRegions, AreAskedForTheOrderThatFitsBestFirst) {
  // A post with ten ridges so low that the tolerance hides by how much of a turn it turns.
  constexpr int kSides = 120;
  Mesh post = test::prism(kSides, 0.3, 0.5);
  for (int i = 0; i < 2 * kSides; ++i) {
    post.vertices.row(i).head<2>() *= 1 + 0.03 * std::cos(10 * 2 * std::numbers::pi * i / kSides);
  }
  const Mesh block = test::moved(test::box(2, 2.4, 0.3), test::shift(0.7, 0.6, -1));
  const Screened both(test::joined({test::subdivided(post, 2), block}));
  Explanation explanation;
  LineRegionOptions options;
  options.explanation = &explanation;
  const Line axis{both.placement("C2").centre, Vector3d::UnitZ()};
  const std::vector<FoundRegion> found =
      find_axis_regions(both.surface(), both.whole(), {axis}, {}, options, {}).regions;
  EXPECT_EQ(symbols(found), std::vector<std::string>{"D10h"});
  ASSERT_FALSE(explanation.notes.empty());
  EXPECT_TRUE(explanation.notes.front().kept) << explanation.notes.front().subject;
}

TEST(AxisRegions, AreLookedForAtAFewOfThePlacesThatAreImages) {
  std::vector<Mesh> posts;
  std::vector<Line> axes;
  for (int i = 0; i < 6; ++i) {
    const Motion turn = Motion::rotation(Vector3d::UnitZ(), i * std::numbers::pi / 3, Vector3d::Zero());
    posts.push_back(test::moved(test::moved(test::prism(5, 0.3, 0.8), test::shift(1, 0, 0)), turn));
  }
  const Screened screened(test::joined(posts));
  for (int i = 0; i < 6; ++i) {
    const Motion turn = Motion::rotation(Vector3d::UnitZ(), i * std::numbers::pi / 3, Vector3d::Zero());
    axes.push_back({screened.placement("C2", turn({1, 0, 0})).centre, Vector3d::UnitZ()});
  }
  LineRegionOptions options;
  EXPECT_EQ(find_axis_regions(screened.surface(), screened.whole(), axes, {}, options, {}).regions.size(), 6U);
  const GroupPlacement whole = screened.placement("C6");
  options.of_whole = judged_motions(whole.group, whole.frame, whole.centre);
  EXPECT_EQ(find_axis_regions(screened.surface(), screened.whole(), axes, {}, options, {}).regions.size(), 3U);
}

TEST(GroupsWithMiddle, AreNotOfPlatesInTheirOwnPlane) {
  // The mirror in its plane keeps every plate.
  for (const double height : {0.01, 0.5}) {
    const Screened plate(test::prism(48, 1, height));
    std::vector<int> samples(plate.surface().samples.faces.size());
    std::iota(samples.begin(), samples.end(), 0);
    const Line axis{plate.placement("C2").centre, Vector3d::UnitZ()};
    EXPECT_EQ(groups_with_middle(plate.surface(), axis, samples, 0.1).empty(), height < 0.1) << height;
  }
}

TEST(RevolutionRegions, AreWithoutDiscsOfAPlateAroundThem) {
  // Most of the plate turns, but it ends in corners.
  const Mesh plate = test::subdivided(test::prism(6, 1, 0.2), 5);
  const Mesh collar = test::prism(60, 0.3, 0.5);
  const Screened both(test::joined({plate, collar}));
  const Line axis{both.placement("C2").centre, Vector3d::UnitZ()};
  RevolutionRegionOptions options;
  options.fine = true;
  const auto [found, axes] = find_revolution_regions(both.surface().prepared, both.whole(), {axis}, {}, options, {});
  EXPECT_EQ(axes.size(), 1U);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_TRUE(found.front().placement.group.continuous());
  EXPECT_EQ(found.front().faces.size(), static_cast<std::size_t>(collar.faces.rows()));
  EXPECT_GE(found.front().faces.front(), plate.faces.rows());
}

// A disc with bolts about its axis, of which one may be missing.
class ThinnedDisc : public testing::TestWithParam<int> {};

TEST_P(ThinnedDisc, KeepsWhatHasItsImagesInIt) {
  const int missing = GetParam();
  const Mesh disc = test::prism(40, 1, 0.3);
  std::vector<Mesh> parts{disc};
  for (int i = 0; i < 8; ++i) {
    const Mesh bolt = test::moved(test::prism(6, 0.08, 0.15), test::shift(0.7, 0, 0.2));
    const Motion turn = Motion::rotation(Vector3d::UnitZ(), i * std::numbers::pi / 4, Vector3d::Zero());
    if (i != missing) parts.push_back(test::moved(bolt, turn));
  }
  const Screened screened(test::joined(parts));
  const PreparedMesh& prepared = screened.surface().prepared;
  const GroupPlacement placement = screened.placement("C8");
  const SurfacePatch patch = make_patch(prepared, screened.surface().faces, 6000, test::kTolerance, {}, "test");
  const Verification verification = verify_group(patch, placement, {});
  EXPECT_EQ(passes(verification), missing < 0);
  const std::vector<int> kept = thinned_region(screened.surface(), patch, verification, placement, {});
  const std::size_t expected = missing < 0 ? patch.faces.size() : static_cast<std::size_t>(disc.faces.rows());
  EXPECT_EQ(kept.size(), expected);
  EXPECT_TRUE(std::ranges::includes(patch.faces, kept));
  EXPECT_LT(kept.back(), static_cast<int>(expected)) << "the disc comes first";
}

INSTANTIATE_TEST_SUITE_P(Missing, ThinnedDisc, testing::Values(-1, 0, 5), [](const auto& each) {
  return each.param < 0 ? "None" : "Bolt" + std::to_string(each.param);
});

// A prism with a smaller one on one of its ends, turned by some angle against it.
struct Stacked {
  int order;
  double turn;  // degrees
  const char* both;

  friend void PrintTo(const Stacked& stacked, std::ostream* out) { *out << stacked.both << " of two prisms"; }
};

// What keeps more than the prism that comes first.
std::vector<FoundRegion> wider_than_prism(const Screened& screened, int order, const Mesh& prism) {
  FoundRegion known{screened.placement("D" + std::to_string(order) + "h"), {}, 0, "prism"};
  for (int f = 0; f < prism.faces.rows(); ++f) known.faces.push_back(f);
  known.area = area_of(screened.surface().prepared, known.faces);
  return screened.wider({known});
}

class MaximalSubgroups : public testing::TestWithParam<Stacked> {};

TEST_P(MaximalSubgroups, KeepWhatTheGroupDoesNot) {
  const auto& [order, turn, both] = GetParam();
  const Mesh lower = test::prism(order, 1, 0.8);
  const Mesh upper = test::moved(test::prism(order, 0.7, 0.9), test::shift(0, 0, 0.85));
  const Motion turned = Motion::rotation(Vector3d::UnitZ(), turn * std::numbers::pi / 180, Vector3d::Zero());
  const Screened screened(test::joined({lower, test::moved(upper, turned)}));
  const std::vector<FoundRegion> found = wider_than_prism(screened, order, lower);
  ASSERT_EQ(symbols(found), std::vector<std::string>{both});
  EXPECT_NEAR(screened.share_of(found.front().faces), 1, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Prisms, MaximalSubgroups,
                         testing::Values(Stacked{3, 0, "C3v"}, Stacked{5, 0, "C5v"}, Stacked{6, 0, "C6v"},
                                         Stacked{8, 0, "C8v"}, Stacked{5, 11, "C5"}, Stacked{6, 11, "C6"}),
                         [](const auto& each) { return std::string(each.param.both); });

TEST(SubgroupsOfAPost, AreNotFoundWhereAllThatIsMoreHasNoPartInThem) {
  const Mesh post = test::prism(6, 1, 4);
  const Mesh block = test::moved(test::box(0.7, 0.4, 0.5), {Eigen::Matrix3d::Identity(), {2.2, 0.3, 0.4}});
  const Screened both(test::joined({post, block}));
  EXPECT_EQ(symbols(wider_than_prism(both, 6, post)), std::vector<std::string>{});
}

TEST(AxisRegions, AreNotFoundAboutAnyAxis) {
  const Screened scalene(test::scalene());
  EXPECT_EQ(symbols(scalene.turning(scalene.surface().prepared.input_of_normalised.translation)),
            std::vector<std::string>{});
}

TEST(PlaneRegions, AreFoundWithoutAnyHint) {
  const Screened box(test::box(1, 1.4, 2.3));
  const std::vector<FoundRegion> found = box.mirrored();
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found.front().placement.group.symbol(), "D2h");  // the largest group of what the first mirror keeps
  EXPECT_NEAR(box.share_of(found.front().faces), 1, 1e-9);
}

TEST(PlaneRegions, AreNotFoundOnAnAsymmetricShape) {
  EXPECT_EQ(symbols(Screened(test::scalene()).mirrored()), std::vector<std::string>{});
}

TEST_P(PrismAbout, HasItsMirrorsWhereTheyAre) {
  // To a fraction of what the tolerance leaves open: ends slide, and only sides tell.
  const int n = GetParam();
  const Screened screened(test::moved(test::subdivided(test::prism(n, 1, 0.3), 3),
                                      {axis_rotation(Vector3d::UnitZ(), 0.0371), Vector3d::Zero()}));
  std::vector<int> samples(screened.surface().samples.faces.size());
  std::iota(samples.begin(), samples.end(), 0);
  const Line axis{screened.placement("C2").centre, Vector3d::UnitZ()};
  const std::vector<AxialGroup> groups = larger_groups(screened.surface(), axis, n, samples, samples, 0.5);
  ASSERT_FALSE(groups.empty());
  EXPECT_EQ(groups.front().placement.group, (PointGroup{PointGroup::Family::Dnh, n}));
  const Vector3d first = groups.front().placement.frame.col(0);
  const double period = std::numbers::pi / n;
  const double off = std::remainder(std::atan2(first.y(), first.x()) - 0.0371, period);
  const double radius = screened.surface().prepared.mesh.vertices.leftCols(2).rowwise().norm().maxCoeff();
  EXPECT_LT(std::abs(off) * radius, 0.25 * test::kTolerance);
}

TEST(GridRegion, TakesNoDiscOutOfAPlane) {
  // Any rotation keeps a disc of the square faces, which is no part of anything.
  const Screened box(test::box(2, 2, 0.5));
  EXPECT_TRUE(grid_region(box.surface(), box.placement("Cinf"), {}).empty());
  EXPECT_NEAR(box.share_of(grid_region(box.surface(), box.placement("C4v"), {})), 1, 1e-9);
}

TEST(GridRegion, TakesWhatIsKeptOfASmallPlane) {
  // Any rotation keeps most of a small square, such as a tooth's end, wherever a host ends.
  const Mesh host = test::subdivided(test::box(2, 2, 2), 4);
  const Mesh block = test::moved(test::subdivided(test::box(0.36, 0.36, 0.36), 4), test::shift(0, 0, 2));
  const Screened both(test::joined({host, block}));
  const std::vector<int> region = grid_region(both.surface(), both.placement("C8"), {});
  EXPECT_GT(region.size(), 500U);
  EXPECT_LT(region.size(), 1024U);  // both ends of the block
  for (const int face : region) EXPECT_GE(face, host.faces.rows());
}

TEST(GridRegion, LeavesOutWhatHasNoImage) {
  // A block at a distance from a plane, without its like on the other side.
  const Mesh middle = test::box(1, 1, 1);
  const Mesh side = test::moved(test::box(0.5, 0.5, 0.5), {Eigen::Matrix3d::Identity(), {0, 0, 2}});
  const Screened both(test::joined({middle, side}));
  const std::vector<int> region = grid_region(both.surface(), both.placement("Cs"), {});
  EXPECT_EQ(region.size(), static_cast<std::size_t>(middle.faces.rows()));
}

// A body with two knobs that one mirror keeps, and two that the other does.
class KnobbedBody : public testing::Test {
 protected:
  static Mesh knob(double x, double y) {
    return test::moved(test::subdivided(test::box(0.3, 0.3, 0.4), 2), test::shift(x, y, 1));
  }

  const Mesh body_ = test::subdivided(test::box(2, 2.4, 1), 3);
  const Screened screened_{
      Screened(test::joined({body_, knob(-0.8, 0.2), knob(0.8, 0.2), knob(0.25, 0.9), knob(0.25, -0.9)}))};

  FoundRegion with_knobs(const Vector3d& normal, int first) const {
    const int faces = static_cast<int>(body_.faces.rows());
    const int each = (static_cast<int>(screened_.surface().faces.size()) - faces) / 4;
    std::vector<int> some = test::all_faces(body_);
    for (int k = 0; k < 2 * each; ++k) some.push_back(faces + first * each + k);
    GroupPlacement mirror = screened_.placement("Cs");
    mirror.frame = frame_about(normal);
    return {mirror, some, screened_.share_of(some) * screened_.surface().prepared.area, "mirrored"};
  }
};

TEST_F(KnobbedBody, HasTheGroupThatItsMirrorsGenerate) {
  const std::vector<FoundRegion> known{with_knobs(Vector3d::UnitX(), 0), with_knobs(Vector3d::UnitY(), 2)};
  const std::vector<FoundRegion> found = find_joined_groups(screened_.surface(), screened_.whole(), {}, known, {}, {});
  ASSERT_EQ(symbols(found), std::vector<std::string>{"C2v"});
  EXPECT_EQ(found.front().faces, test::all_faces(body_));
  EXPECT_LT(found.front().placement.frame.col(2).cross(Vector3d::UnitZ()).norm(), 1e-9);
}

TEST_F(KnobbedBody, SaysNothingThatIsKnown) {
  std::vector<FoundRegion> known{with_knobs(Vector3d::UnitX(), 0), with_knobs(Vector3d::UnitY(), 2)};
  const std::vector<int> body = test::all_faces(body_);
  known.push_back({screened_.placement("D2h", {0, 0, 0}), body,
                   screened_.share_of(body) * screened_.surface().prepared.area, "body"});
  EXPECT_EQ(symbols(find_joined_groups(screened_.surface(), screened_.whole(), {}, known, {}, {})),
            std::vector<std::string>{});
}

// A post with a block at its side, which alone says which of the planes through the axis is meant.
class PostWithBlock : public testing::TestWithParam<double> {};

TEST_P(PostWithBlock, IsMirroredInThePlaneThroughBoth) {
  const Motion turn = Motion::rotation(Vector3d::UnitZ(), GetParam(), Vector3d::Zero());
  const Mesh block = test::moved(test::subdivided(test::box(0.3, 0.25, 0.6), 2), test::shift(1.15, 0, 0.3));
  const Mesh stop = test::moved(test::subdivided(test::box(0.2, 0.3, 0.3), 2), test::shift(0.3, 0.9, -0.5));
  const Screened both(
      test::joined({test::subdivided(test::prism(96, 1, 2), 2), test::moved(block, turn), test::moved(stop, turn)}));
  const Line axis{both.placement("C2").centre, Vector3d::UnitZ()};
  const std::vector<CandidateLine> planes = mirror_planes(both.surface(), {axis}, 0.02, {});
  ASSERT_FALSE(planes.empty());
  const Vector3d normal = turn.linear * Vector3d::UnitY();
  EXPECT_LT(planes.front().line.direction.cross(normal).norm(), 0.01);
  EXPECT_LT(std::abs((planes.front().line.point - axis.point).dot(normal)), 1e-12) << "through the axis";
}

INSTANTIATE_TEST_SUITE_P(Angles, PostWithBlock, testing::Values(0, 0.3, 1.1, 2.9));

}  // namespace
}  // namespace orbifit

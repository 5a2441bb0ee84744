// Regions found on the surface itself: rotations about given axes, mirrors, and what the grid says of a group.

#include <algorithm>
#include <numbers>
#include <numeric>
#include <string>

#include <gtest/gtest.h>

#include "orbifit/detection/axis_regions.h"
#include "orbifit/detection/own_group.h"
#include "orbifit/detection/plane_regions.h"
#include "orbifit/detection/segments.h"

#include "shapes.h"

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

  const ScreenedSurface& surface() const { return surface_; }

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

TEST(GridRegion, TakesNoDiscOutOfAPlane) {
  // Any rotation keeps a disc of the square faces, which is no part of anything.
  const Screened box(test::box(2, 2, 0.5));
  EXPECT_TRUE(grid_region(box.surface(), box.placement("Cinf"), {}).empty());
  EXPECT_NEAR(box.share_of(grid_region(box.surface(), box.placement("C4v"), {})), 1, 1e-9);
}

TEST(GridRegion, LeavesOutWhatHasNoImage) {
  // A block at a distance from a plane, without its like on the other side.
  const Mesh middle = test::box(1, 1, 1);
  const Mesh side = test::moved(test::box(0.5, 0.5, 0.5), {Eigen::Matrix3d::Identity(), {0, 0, 2}});
  const Screened both(test::joined({middle, side}));
  const std::vector<int> region = grid_region(both.surface(), both.placement("Cs"), {});
  EXPECT_EQ(region.size(), static_cast<std::size_t>(middle.faces.rows()));
}

}  // namespace
}  // namespace orbifit

#include "support/found_region.h"

#include <algorithm>
#include <numbers>
#include <ostream>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "base/random.h"
#include "placements.h"
#include "shapes.h"

namespace orbifit {
namespace {

using Eigen::Vector3d;

// A plate with four equal blocks upon it, a post on the axis and a speck.
class Regions : public testing::Test {
 protected:
  Regions() {
    std::vector<Mesh> parts{test::box(2, 2, 0.2)};
    for (int i = 0; i < 4; ++i) {
      const Mesh block = test::moved(test::box(0.3, 0.4, 0.5), test::shift(0.7, 0, 0.4));
      parts.push_back(test::moved(block, Motion::rotation({0, 0, 1}, i * std::numbers::pi / 2, {0, 0, 0})));
    }
    parts.push_back(test::moved(test::box(0.2, 0.2, 0.6), test::shift(0, 0, 0.5)));
    parts.push_back(test::moved(test::box(0.01, 0.01, 0.01), test::shift(0.3, 0.4, 0.2)));
    prepared_ = prepare(test::joined(parts));
  }

  FoundRegion region(const char* symbol, const std::vector<int>& parts,
                     const Vector3d& axis = Vector3d::UnitZ()) const {
    FoundRegion result;
    result.placement =
        test::normalised(prepared_, {*PointGroup::parse(symbol), frame_about(axis, Vector3d::UnitX()), {0, 0, 0}});
    for (const int c : parts) {
      const std::vector<int>& faces = prepared_.components.faces[static_cast<std::size_t>(c)];
      result.faces.insert(result.faces.end(), faces.begin(), faces.end());
    }
    std::ranges::sort(result.faces);
    result.area = surface_moments(prepared_, result.faces).area;
    result.name = std::string(symbol) + " of " + std::to_string(parts.size());
    return result;
  }

  std::vector<std::string> kept(std::vector<FoundRegion> regions, Explanation* explanation = nullptr) const {
    drop_repeats(prepared_, test::kTolerance, regions, explanation);
    std::vector<std::string> names;
    for (const FoundRegion& each : regions) names.push_back(each.name);
    return names;
  }

  // What stays of two regions, whichever comes first, in alphabetical order.
  std::vector<std::string> kept_either_way(const FoundRegion& a, const FoundRegion& b) const {
    std::vector<std::string> one = kept({a, b});
    std::vector<std::string> other = kept({b, a});
    std::ranges::sort(one);
    std::ranges::sort(other);
    EXPECT_EQ(one, other) << "whichever came first";
    return one;
  }

  PreparedMesh prepared_;
};

using Names = std::vector<std::string>;

TEST_F(Regions, AreaOutsideIsThatOfTheDifference) {
  Random random(1);
  for (int trial = 0; trial < 50; ++trial) {
    std::vector<int> a;
    std::vector<int> b;
    std::vector<int> difference;
    for (int f = 0; f < prepared_.mesh.faces.rows(); ++f) {
      const bool in_a = random.below(2) == 0;
      const bool in_b = random.below(3) == 0;
      if (in_a) a.push_back(f);
      if (in_b) b.push_back(f);
      if (in_a && !in_b) difference.push_back(f);
    }
    double expected = 0;
    for (const int f : difference) expected += prepared_.areas[f];
    EXPECT_NEAR(area_outside(prepared_, a, b), expected, 1e-14);
    EXPECT_EQ(area_outside(prepared_, a, a), 0);
  }
  EXPECT_EQ(area_outside(prepared_, {}, {0, 1}), 0);
  EXPECT_EQ(area_outside(prepared_, {2}, {}), prepared_.areas[2]);
}

TEST_F(Regions, CoverWhatLiesInThemButForASliver) {
  const FoundRegion all = region("C4v", {0, 1, 2, 3, 4, 5, 6});
  const FoundRegion clean = region("C4v", {0, 1, 2, 3, 4, 5});
  const FoundRegion lacking = region("C4v", {0, 1, 2, 3, 5});
  const FoundRegion post = region("D4h", {5});
  EXPECT_TRUE(covers(prepared_, all, all));
  EXPECT_TRUE(covers(prepared_, all, post));
  EXPECT_FALSE(covers(prepared_, post, all));
  EXPECT_TRUE(covers(prepared_, clean, all)) << "the speck is a sliver";
  EXPECT_FALSE(covers(prepared_, lacking, all)) << "a block is not";
  EXPECT_TRUE(covers(prepared_, all, lacking));
  EXPECT_FALSE(covers(prepared_, region("C4v", {0}), post));
  EXPECT_FALSE(covers(prepared_, all, FoundRegion{}));
}

TEST_F(Regions, WithinOneThatSaysAsMuchAreDropped) {
  const FoundRegion all = region("C4v", {0, 1, 2, 3, 4, 5});
  EXPECT_EQ(kept_either_way(all, region("C2v", {1, 3})), (Names{"C4v of 6"})) << "a subgroup on less";
  EXPECT_EQ(kept_either_way(all, region("C4v", {1, 2, 3, 4})), (Names{"C4v of 6"})) << "the same on less";
  EXPECT_EQ(kept_either_way(all, region("C4", {0, 1, 2, 3, 4, 5})), (Names{"C4v of 6"})) << "a subgroup on all";
  EXPECT_EQ(kept_either_way(all, region("D4h", {5})), (Names{"C4v of 6", "D4h of 1"})) << "more on less";
  EXPECT_EQ(kept_either_way(all, region("C2", {1, 3}, {1, 0, 0})), (Names{"C2 of 2", "C4v of 6"})) << "another axis";
  EXPECT_EQ(kept_either_way(region("D4h", {0, 5}), all), (Names{"C4v of 6", "D4h of 2"}));
}

TEST_F(Regions, TheEarlierOfTwoThatSayTheSameStays) {
  FoundRegion first = region("C4v", {0, 1, 2, 3, 4, 5});
  FoundRegion second = region("C4v", {0, 1, 2, 3, 4, 5, 6});
  first.name = "first";
  second.name = "second";
  EXPECT_EQ(kept({first, second}), Names{"first"});
  EXPECT_EQ(kept({second, first}), Names{"second"});
  EXPECT_EQ(kept({first, first, second, first}), Names{"first"});
}

TEST_F(Regions, LackingOnePartAreNoRepeat) {
  // More of a smaller group: not all of it lies in the region that lacks a block.
  EXPECT_EQ(kept_either_way(region("C4v", {0, 5}), region("C2v", {0, 1, 3, 5})), (Names{"C2v of 4", "C4v of 2"}));
  EXPECT_EQ(kept_either_way(region("C4v", {0, 1, 2, 3, 5}), region("Cs", {0, 1, 2, 3, 4, 5}, {1, 0, 0})),
            (Names{"C4v of 5", "Cs of 6"}));
}

// Two wheels on one axle, which lean in by some degrees.
class Axle : public testing::TestWithParam<double> {};

TEST_P(Axle, WheelsStayBesideItUnlessItFitsAsWell) {
  const Mesh wheel = test::moved(test::prism(5, 0.3, 0.1), test::shift(0, 0, 0.4));
  const Motion lean = Motion::rotation({1, 0, 0}, GetParam() * std::numbers::pi / 180, {0, 0, 0.4});
  const Motion across{Vector3d(1, 1, -1).asDiagonal(), Vector3d::Zero()};
  const Mesh left = test::moved(wheel, lean);
  const PreparedMesh prepared = prepare(test::joined({left, test::moved(left, across)}));
  const auto region = [&](const char* symbol, const GroupFrame& frame, const Vector3d& centre, std::vector<int> parts) {
    FoundRegion result;
    result.placement = test::normalised(prepared, {*PointGroup::parse(symbol), frame, centre});
    for (const int c : parts) {
      const std::vector<int>& faces = prepared.components.faces[static_cast<std::size_t>(c)];
      result.faces.insert(result.faces.end(), faces.begin(), faces.end());
    }
    result.area = surface_moments(prepared, result.faces).area;
    result.name = symbol;
    return result;
  };
  std::vector<FoundRegion> regions{
      region("D5h", GroupFrame::Identity(), {0, 0, 0}, {0, 1}),
      region("C5v", frame_about(lean.linear.col(2), lean.linear.col(1)), {0, 0, 0.4}, {0})};
  drop_repeats(prepared, test::kTolerance, regions);
  EXPECT_EQ(regions.size(), GetParam() > 0.1 ? 2U : 1U);
  // Pieces of surface end by chance; they do not stay for it.
  regions = {region("D5h", GroupFrame::Identity(), {0, 0, 0}, {0, 1}),
             region("C5v", frame_about(lean.linear.col(2), lean.linear.col(1)), {0, 0, 0.4}, {0})};
  regions[1].of_pieces = true;
  drop_repeats(prepared, test::kTolerance, regions);
  EXPECT_EQ(regions.size(), 1U);
}

INSTANTIATE_TEST_SUITE_P(Degrees, Axle, testing::Values(0, 0.02, 0.8, 1));

// Pieces of surface about blocks of the same group, by so many degrees off where the blocks stand.
class Tilted : public Regions, public testing::WithParamInterface<double> {
 protected:
  FoundRegion of_pieces(const std::vector<int>& parts) const {
    FoundRegion result = region("C4v", parts);
    const Motion off = Motion::rotation({1, 2, 0}, GetParam() * std::numbers::pi / 180, {0, 0, 0});
    result.placement.frame = off.linear * result.placement.frame;
    result.of_pieces = true;
    return result;
  }
};

TEST_P(Tilted, TheLargerTakesThePlacementOfComponentsThatAreExact) {
  for (const bool larger_first : {true, false}) {
    const FoundRegion blocks = region("C4v", {1, 2, 3, 4});
    std::vector<FoundRegion> regions{of_pieces({0, 1, 2, 3, 4, 5}), blocks};
    if (!larger_first) std::ranges::reverse(regions);
    drop_repeats(prepared_, test::kTolerance, regions);
    ASSERT_EQ(regions.size(), 1U);
    EXPECT_TRUE(regions.front().of_pieces);
    EXPECT_EQ(regions.front().placement.frame, blocks.placement.frame);
    EXPECT_EQ(regions.front().placement.centre, blocks.placement.centre);
  }
}

TEST_P(Tilted, ComponentsThatAreMostOfItStayBesideIt) {
  const FoundRegion most = region("C4v", {0, 1, 2, 3, 4});
  std::vector<FoundRegion> regions{of_pieces({0, 1, 2, 3, 4, 5}), most};
  drop_repeats(prepared_, test::kTolerance, regions);
  EXPECT_EQ(regions.size(), GetParam() > 0 ? 2U : 1U);
}

INSTANTIATE_TEST_SUITE_P(Degrees, Tilted, testing::Values(0, 0.01, 0.2));

TEST_F(Regions, AnOrderOfRegionsChangesWhichStayOnlyAmongEquals) {
  std::vector<FoundRegion> regions{region("C4v", {0, 1, 2, 3, 4, 5}),
                                   region("D4h", {5}),
                                   region("D2h", {5}),
                                   region("C2v", {1, 3}),
                                   region("D4h", {0, 5}),
                                   region("C4v", {0}),
                                   region("Cs", {1}, {0, 1, 0}),
                                   region("C2v", {1, 2, 3}, {1, 0, 0})};
  std::vector<std::string> expected = kept(regions);
  std::ranges::sort(expected);
  Random random(2);
  for (int trial = 0; trial < 20; ++trial) {
    for (std::size_t i = regions.size(); i > 1; --i) std::swap(regions[i - 1], regions[random.below(i)]);
    std::vector<std::string> names = kept(regions);
    std::ranges::sort(names);
    EXPECT_EQ(names, expected);
  }
}

TEST_F(Regions, EveryDropIsExplained) {
  Explanation explanation;
  const std::vector<FoundRegion> regions{region("C4v", {0, 1, 2, 3, 4, 5}), region("C2v", {1, 3}), region("C4", {0}),
                                         region("D4h", {5})};
  const std::size_t stay = kept(regions, &explanation).size();
  EXPECT_EQ(explanation.notes.size(), regions.size() - stay);
  for (const Explanation::Note& note : explanation.notes) {
    EXPECT_FALSE(note.kept);
    EXPECT_EQ(note.stage, "repeats");
    EXPECT_NE(note.reason.find("C4v of 6"), std::string::npos) << "names what says as much";
  }
}

// A square sheet of n by n cells, column by column.
PreparedMesh flat_sheet(int n) {
  return prepare(test::sheet(n, [](double, double) { return 0.0; }));
}

FoundRegion columns(const PreparedMesh& prepared, int n, int count) {
  FoundRegion region;
  for (int f = 0; f < 2 * n * count; ++f) region.faces.push_back(f);
  region.area = area_of(prepared, region.faces);
  return region;
}

class Sheet : public testing::TestWithParam<int> {};

TEST_P(Sheet, ARegionsBorderIsUncertainByASmallTriangle) {
  const int n = GetParam();
  const PreparedMesh prepared = flat_sheet(n);
  const FoundRegion outer = columns(prepared, n, n / 2);
  const bool fine = n > 100;
  EXPECT_TRUE(covers(prepared, outer, columns(prepared, n, n / 2)));
  EXPECT_EQ(covers(prepared, outer, columns(prepared, n, n / 2 + 1)), fine);
  EXPECT_FALSE(covers(prepared, outer, columns(prepared, n, n / 2 + 3)));
}

INSTANTIATE_TEST_SUITE_P(Cells, Sheet, testing::Values(24, 120));

struct Coincidence {
  const char* name;
  double area, residual, area_around, residual_around;
  bool expected;

  friend void PrintTo(const Coincidence& each, std::ostream* stream) { *stream << each.name; }
};

class ByCoincidence : public testing::TestWithParam<Coincidence> {};

TEST_P(ByCoincidence, IsASmallPartFarLessExactThanWhatIsAround) {
  const Coincidence& each = GetParam();
  EXPECT_EQ(by_coincidence(each.area, each.residual, each.area_around, each.residual_around, test::kTolerance),
            each.expected);
}

INSTANTIATE_TEST_SUITE_P(Cases, ByCoincidence,
                         testing::Values(Coincidence{"SmallAndFarOff", 0.1, 3e-3, 1, 1e-12, true},
                                         Coincidence{"SmallAndAsExact", 0.1, 2e-12, 1, 1e-12, false},
                                         Coincidence{"BothLoose", 0.1, 3e-3, 1, 1e-3, false},
                                         Coincidence{"NoneIsExact", 0.1, 3e-3, 1, 1e-4, false},
                                         Coincidence{"TheLargerPart", 0.6, 3e-3, 1, 1e-12, false},
                                         Coincidence{"NextToNothing", 0.1, 0.1 * test::kTolerance, 1, 0, false}),
                         [](const auto& each) { return std::string(each.param.name); });

TEST(DropFeatureless, PiecesOfALargerSurfaceGoTheWholeStays) {
  // Seen alone a tile on a slab is a rectangle; upon the slab it slides. A tile that stands out does not.
  const Mesh slab = test::box(4, 4, 0.01);
  const Mesh tile = test::moved(test::box(0.4, 0.3, 0.01), test::shift(0.5, 0.2, 0.006));
  const Mesh block = test::moved(test::box(0.4, 0.3, 0.5), test::shift(-0.8, 0.7, 0.3));
  const PreparedMesh prepared = prepare(test::joined({slab, tile, block}));
  const SurfaceIndex whole(prepared.mesh);
  std::vector<FoundRegion> regions;
  for (std::size_t c = 0; c < 3; ++c) {
    const SurfaceMoments moments = surface_moments(prepared, prepared.components.faces[c]);
    regions.push_back({{*PointGroup::parse("D2h"), GroupFrame::Identity(), moments.centroid},
                       prepared.components.faces[c],
                       moments.area,
                       std::to_string(c)});
  }
  Explanation explanation;
  drop_featureless(prepared, whole, test::kTolerance, RunContext{}, regions, &explanation);
  ASSERT_EQ(regions.size(), 2U);
  EXPECT_EQ(regions[0].name, "0");
  EXPECT_EQ(regions[1].name, "2");
  ASSERT_EQ(explanation.notes.size(), 1U);
  EXPECT_EQ(explanation.notes[0].stage, "featureless");
  EXPECT_FALSE(explanation.notes[0].kept);
}

TEST_F(Regions, OfGroupsOnTheSameFacesTheLargestStays) {
  const std::vector<int> all{0, 1, 2, 3, 4, 5};
  const FoundRegion four = region("C4v", all);
  const FoundRegion two = region("C2h", all, {1, 0, 0});
  const FoundRegion post = region("D4h", {5});
  for (std::vector<FoundRegion> regions : {std::vector{four, two, post}, {two, post, four}, {post, four, two}}) {
    Explanation explanation;
    drop_lesser_groups(prepared_, test::kTolerance, regions, &explanation);
    Names names;
    for (const FoundRegion& each : regions) names.push_back(each.name);
    std::ranges::sort(names);
    EXPECT_EQ(names, (Names{"C4v of 6", "D4h of 1"}));
    ASSERT_EQ(explanation.notes.size(), 1U);
    EXPECT_FALSE(explanation.notes[0].kept);
  }
}

TEST_F(Regions, OfEqualGroupsOnTheSameFacesTheOneThatFitsStays) {
  const std::vector<int> all{0, 1, 2, 3, 4, 5};
  const FoundRegion fits = region("C2v", all);
  const FoundRegion fits_not = region("C2v", all, {1, 1, 0});
  for (std::vector<FoundRegion> regions : {std::vector{fits, fits_not}, {fits_not, fits}}) {
    drop_lesser_groups(prepared_, test::kTolerance, regions);
    ASSERT_EQ(regions.size(), 1U);
    EXPECT_EQ(regions[0].placement.frame, fits.placement.frame);
  }
}

TEST(OneGroup, StaysOfTheSameOnNearlyTheSameFaces) {
  constexpr int kColumns = 40;
  const PreparedMesh prepared = flat_sheet(kColumns);
  for (const auto& [symbol, fewer, stay] :
       {std::tuple{"C2v", 39, 1U}, {"C2v", 38, 2U}, {"C4v", 39, 2U}, {"Cs", 39, 2U}}) {
    FoundRegion a = columns(prepared, kColumns, kColumns);
    FoundRegion b = columns(prepared, kColumns, fewer);
    a.placement.group = *PointGroup::parse("C2v");
    b.placement.group = *PointGroup::parse(symbol);
    for (std::vector<FoundRegion> regions : {std::vector{a, b}, {b, a}}) {
      drop_lesser_groups(prepared, test::kTolerance, regions);
      ASSERT_EQ(regions.size(), stay) << symbol << " on " << fewer;
      if (stay == 1) {
        EXPECT_EQ(regions[0].faces, a.faces) << "the larger";
      }
    }
  }
}

// A region of D8h over 20 of 40 columns, and one of a subgroup over some more.
struct Wider {
  const char* symbol;
  int columns;
  bool stays;

  friend void PrintTo(const Wider& wider, std::ostream* out) { *out << wider.symbol << " on " << wider.columns; }
};

class Subgroup : public testing::TestWithParam<Wider> {};

TEST_P(Subgroup, MustKeepMoreTheSmallerItIs) {
  constexpr int kColumns = 40;
  constexpr int kOuter = 20;
  const auto& [symbol, count, stays] = GetParam();
  const PreparedMesh prepared = flat_sheet(kColumns);
  FoundRegion outer = columns(prepared, kColumns, kOuter);
  FoundRegion inner = columns(prepared, kColumns, count);
  outer.placement.group = *PointGroup::parse("D8h");
  inner.placement.group = *PointGroup::parse(symbol);
  const std::vector<FoundRegion> both{outer, inner};
  for (std::vector<FoundRegion> regions : {both, std::vector<FoundRegion>(both.rbegin(), both.rend())}) {
    drop_repeats(prepared, test::kTolerance, regions);
    EXPECT_EQ(regions.size(), stays ? 2U : 1U);
  }
}

INSTANTIATE_TEST_SUITE_P(Shares, Subgroup,
                         testing::Values(Wider{"Cs", 24, false}, Wider{"Cs", 26, true}, Wider{"C2", 24, false},
                                         Wider{"C2v", 22, false}, Wider{"C2v", 24, true}, Wider{"C4v", 22, true},
                                         Wider{"C8v", 22, true}, Wider{"C8v", 20, false}, Wider{"Cs", 40, true}),
                         [](const auto& each) { return each.param.symbol + std::to_string(each.param.columns); });

}  // namespace
}  // namespace orbifit

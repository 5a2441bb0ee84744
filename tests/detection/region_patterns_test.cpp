#include "patterns/region_patterns.h"

#include <numbers>
#include <numeric>
#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "placements.h"
#include "shapes.h"

namespace orbifit {
namespace {

// Bolts on a slab, a region of each, and what is made of them.
struct Bolts {
  const char* name;
  int count;
  bool ring;         // at equal angles about the slab's middle
  bool whole_known;  // the ring's group is a region
  int repeats;       // how often the pattern is asked for, being known afterwards
  std::size_t instances;

  friend void PrintTo(const Bolts& bolts, std::ostream* out) { *out << bolts.name; }
};

class RegionPatterns : public testing::TestWithParam<Bolts> {
 protected:
  void SetUp() override {
    const Bolts& bolts = GetParam();
    std::vector<Mesh> parts{test::prism(bolts.count, 2, 0.3)};
    std::vector<Motion> places;
    for (int i = 0; i < bolts.count; ++i) {
      const double angle = bolts.ring ? 2 * std::numbers::pi * i / bolts.count : 1.1 * i + 0.07 * i * i;
      const Motion turn = Motion::rotation({0, 0, 1}, angle, {0, 0, 0});
      places.push_back(turn * test::shift(bolts.ring ? 1.2 : 0.7 + 0.15 * i, 0, 0.3));
      parts.push_back(test::moved(test::subdivided(test::prism(6, 0.2, 0.3), 2), places.back()));
    }
    prepared_ = prepare(test::joined(parts));
    const PointGroup group = *PointGroup::parse("C6v");
    for (std::size_t i = 0; i < places.size(); ++i) {
      const GroupPlacement placement{group, places[i].linear, places[i].translation};
      const std::vector<int>& faces = prepared_.components.faces[i + 1];
      regions_.push_back({test::normalised(prepared_, placement), faces, area_of(prepared_, faces), "bolt"});
    }
    if (!bolts.whole_known) return;
    std::vector<int> all(static_cast<std::size_t>(prepared_.mesh.faces.rows()));
    std::iota(all.begin(), all.end(), 0);
    const GroupPlacement whole{{PointGroup::Family::Cnv, bolts.count}, GroupFrame::Identity(), {0, 0, 0}};
    regions_.push_back({test::normalised(prepared_, whole), all, prepared_.area, "whole"});
  }

  PreparedMesh prepared_;
  std::vector<FoundRegion> regions_;
};

TEST_P(RegionPatterns, AreOfThreeOrMoreThatNoGroupRelates) {
  const Bolts& bolts = GetParam();
  PartRegionOptions options;
  options.tolerance = test::kTolerance;
  std::vector<Pattern> known;
  for (int k = 1; k < bolts.repeats; ++k) known = find_region_patterns(prepared_, regions_, {}, options, {});
  const std::vector<Pattern> found = find_region_patterns(prepared_, regions_, known, options, {});
  ASSERT_EQ(found.size(), bolts.instances > 0 ? 1U : 0U);
  if (found.empty()) return;
  ASSERT_EQ(found[0].instances.size(), bolts.instances);
  EXPECT_LT(found[0].residual.max, 1e-6);
  for (std::size_t i = 0; i < bolts.instances; ++i) EXPECT_EQ(found[0].instances[i].faces, regions_[i].faces) << i;
}

INSTANTIATE_TEST_SUITE_P(Slabs, RegionPatterns,
                         testing::Values(Bolts{"Scattered", 5, false, false, 1, 5},
                                         Bolts{"KnownAlready", 5, false, false, 2, 0},
                                         Bolts{"Pair", 2, false, false, 1, 0}, Bolts{"Ring", 7, true, false, 1, 7},
                                         Bolts{"RingOfAGroup", 7, true, true, 1, 0}),
                         [](const auto& each) { return std::string(each.param.name); });

}  // namespace
}  // namespace orbifit

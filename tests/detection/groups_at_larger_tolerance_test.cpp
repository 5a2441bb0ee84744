#include "search/groups_at_larger_tolerance.h"

#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "shapes.h"

namespace orbifit {
namespace {

// A box with a plate on one end, as thick as a share of the diagonal: the mirror to the other end is off by
// that there, the others are exact.
struct Plated {
  const char* name;
  double thickness;
  const char* has;
  std::vector<std::string> expected;

  friend void PrintTo(const Plated& plated, std::ostream* out) { *out << plated.name; }
};

class LargerToleranceGroups : public testing::TestWithParam<Plated> {};

TEST_P(LargerToleranceGroups, AreThoseThatTheToleranceHides) {
  const Mesh box = test::box(1, 2, 3);
  const double thickness = GetParam().thickness * diagonal(box.vertices);
  const Mesh plate = test::moved(test::box(thickness, 0.7, 1.2), test::shift(0.5 + 0.5 * thickness, 0, 0));
  const std::string has = GetParam().has;
  std::vector<std::string> found;
  for (const LargerToleranceGroup& each : groups_at_larger_tolerance(
           prepare(test::joined({box, plate})), has.empty() ? std::nullopt : PointGroup::parse(has), test::kTolerance,
           hemisphere_directions(500), RunContext{})) {
    found.push_back(each.group.symbol() + " at " + std::to_string(each.tolerance / test::kTolerance).substr(0, 1));
  }
  EXPECT_EQ(found, GetParam().expected);
}

INSTANTIATE_TEST_SUITE_P(Boxes, LargerToleranceGroups,
                         testing::Values(Plated{"Known", 0.016, "D2h", {}}, Plated{"Thin", 0.008, "C2v", {"D2h at 2"}},
                                         Plated{"Thicker", 0.016, "C2v", {"D2h at 4"}}, Plated{"Thick", 0.1, "C2v", {}},
                                         Plated{"NothingKnown", 0.1, "", {"C2v at 2"}},
                                         Plated{"BothSteps", 0.016, "Cs", {"C2v at 2", "D2h at 4"}},
                                         Plated{"Continuous", 0.016, "Cinfv", {}}),
                         [](const auto& each) { return std::string(each.param.name); });

}  // namespace
}  // namespace orbifit

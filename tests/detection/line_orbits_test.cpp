#include "primitives/line_orbits.h"

#include <algorithm>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "group/verification.h"
#include "shapes.h"

namespace orbifit {
namespace {

using Eigen::Vector3d;

// Lines along z, one for each of six places about the origin.
std::vector<Line> ring() {
  std::vector<Line> lines;
  for (int i = 0; i < 6; ++i) {
    const Motion turn = Motion::rotation(Vector3d::UnitZ(), i * std::numbers::pi / 3, Vector3d::Zero());
    lines.push_back({turn({0.4, 0, 0.1 * i}), i % 2 == 0 ? Vector3d::UnitZ() : Vector3d(-Vector3d::UnitZ())});
  }
  return lines;
}

std::vector<char> few_under(const char* group, const std::vector<Line>& lines) {
  return few_of_each_orbit(lines, judged_motions(*PointGroup::parse(group), GroupFrame::Identity(), Vector3d::Zero()),
                           test::kTolerance);
}

TEST(LineOrbits, AreLookedAtThreeTimes) {
  EXPECT_EQ(few_under("C6", ring()), (std::vector<char>{1, 1, 1, 0, 0, 0}));
}

TEST(LineOrbits, AreLookedAtFurtherWhereSomethingIsFound) {
  const std::vector<Line> lines = ring();
  LineOrbits orbits(lines, judged_motions({PointGroup::Family::Cn, 6}, GroupFrame::Identity(), Vector3d::Zero()),
                    test::kTolerance);
  std::vector<bool> looked;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    looked.push_back(orbits.worth_a_look(i));
    if (i == 2) orbits.found(i);
  }
  EXPECT_EQ(looked, std::vector<bool>(6, true));
}

TEST(LineOrbits, AreAsManyAsTheGroupLeaves) {
  // Under these every other line is in the same orbit, and there are no more than three in each.
  EXPECT_EQ(std::ranges::count(few_under("C3", ring()), 1), 6);
  EXPECT_EQ(std::ranges::count(few_under("D3", ring()), 1), 6);
}

TEST(LineOrbits, AreOfOneLineEachWithoutAGroup) {
  EXPECT_EQ(few_of_each_orbit(ring(), {}, test::kTolerance), std::vector<char>(6, 1));
}

TEST(LineOrbits, HoldWhatIsNearAnImageOnly) {
  std::vector<Line> lines = ring();
  lines[4].point.x() += 3 * test::kTolerance;
  lines[5].direction = Vector3d(0.1, 0, 1).normalized();
  EXPECT_EQ(few_under("C6", lines), (std::vector<char>{1, 1, 1, 0, 1, 1}));
}

}  // namespace
}  // namespace orbifit

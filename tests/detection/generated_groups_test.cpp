// What two groups generate together.

#include "search/generated_groups.h"

#include <cmath>
#include <numbers>
#include <optional>
#include <ostream>
#include <string>

#include <gtest/gtest.h>

#include "base/random.h"
#include "group/verification.h"
#include "placements.h"

namespace orbifit {
namespace {

using Eigen::Vector3d;

constexpr double kTolerance = 0.005;

struct Part {
  std::string symbol;
  Vector3d axis;     // or the mirror's normal
  Vector3d towards;  // column 0 of the frame, as near as may be
};

struct Case {
  std::string name;
  Part a, b;
  std::string joined;  // empty: none
};

void PrintTo(const Case& each, std::ostream* out) {
  *out << each.name;
}

GroupPlacement placed(const Part& part, const Vector3d& centre = Vector3d::Zero()) {
  return {*PointGroup::parse(part.symbol), frame_about(part.axis.normalized(), part.towards), centre};
}

const Vector3d kX = Vector3d::UnitX();
const Vector3d kY = Vector3d::UnitY();
const Vector3d kZ = Vector3d::UnitZ();
const Vector3d kDiagonal(1, 1, 1);
const Vector3d kGolden(0, 1, std::numbers::phi);  // a fivefold axis of I with twofold ones along the frame

// Between mirrors: fractions of a turn that are as fine make a group of any two mirrors, roughly.
const double kSmallAngle = std::numbers::pi / 24;

class JoinedGroup : public testing::TestWithParam<Case> {};

TEST_P(JoinedGroup, IsTheOneThatBothGenerate) {
  const Case& each = GetParam();
  const std::optional<GroupPlacement> joined =
      joined_group(placed(each.a), placed(each.b), {0.1, 0.2, 0.3}, kTolerance);
  EXPECT_EQ(joined ? joined->group.symbol() : "", each.joined);
  if (!joined) return;
  for (const Part& part : {each.a, each.b}) {
    EXPECT_LT(test::farthest(test::motions_of(placed(part)), test::motions_of(*joined)), 1e-9) << part.symbol;
  }
}

TEST_P(JoinedGroup, IsTheSameWhereBothAreALittleOffInAnyPose) {
  const Case& each = GetParam();
  Random random(7);
  for (int round = 0; round < 5; ++round) {
    const Motion pose = Motion::rotation(random.direction(), 3 * random.uniform(), {0, 0, 0});
    const auto put = [&](const Part& part) {
      const Motion off = Motion::rotation(random.direction(), 0.008, {0, 0, 0});
      GroupPlacement result = placed(part, 0.2 * kTolerance * random.direction());
      result.frame = off.linear * pose.linear * result.frame;
      return result;
    };
    const std::optional<GroupPlacement> joined = joined_group(put(each.a), put(each.b), {0, 0, 0}, kTolerance);
    EXPECT_EQ(joined ? joined->group.symbol() : "", each.joined);
    const std::optional<GroupPlacement> other = joined_group(put(each.b), put(each.a), {0, 0, 0}, kTolerance);
    EXPECT_EQ(other ? other->group.symbol() : "", each.joined);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Pairs, JoinedGroup,
    testing::Values(
        Case{"MirrorAndHalfTurnInIt", {"Cs", kX, kY}, {"C2", kZ, kX}, "C2v"},
        Case{"MirrorAndHalfTurnAcrossIt", {"Cs", kZ, kY}, {"C2", kZ, kX}, "C2h"},
        Case{"TwoMirrors", {"Cs", kX, kY}, {"Cs", kY, kX}, "C2v"},
        Case{"TwoMirrorsSixthOfATurnApart", {"Cs", kX, kY}, {"Cs", Vector3d(0.5, std::sqrt(0.75), 0), kZ}, "C3v"},
        Case{"TwoMirrorsAtASmallAngle",
             {"Cs", kX, kY},
             {"Cs", Vector3d(std::cos(kSmallAngle), std::sin(kSmallAngle), 0), kZ},
             ""},
        Case{"TwoHalfTurns", {"C2", kX, kY}, {"C2", kY, kX}, "D2"},
        Case{"Dihedral", {"C5", kZ, kX}, {"C2", kX, kY}, "D5"}, Case{"Prism", {"C6v", kZ, kX}, {"Cs", kZ, kX}, "D6h"},
        Case{"Antiprism", {"S8", kZ, kX}, {"C2", kX, kY}, "D4d"},
        Case{"LinksOfAChain", {"C2h", kX, kY}, {"C2v", kZ, kX}, "D2h"},
        Case{"Tetrahedron", {"C3", kDiagonal, kX}, {"C2", kZ, kX}, "T"},
        Case{"Cube", {"C3", kDiagonal, kX}, {"C4", kZ, kX}, "O"},
        Case{"Icosahedron", {"C5", kGolden, kX}, {"C2", kZ, kX}, "I"},
        Case{"WithTheInversion", {"I", kZ, kX}, {"Ci", kZ, kX}, "Ih"},
        Case{"OneHoldsTheOther", {"C4v", kZ, kX}, {"C2", kZ, kX}, ""}, Case{"Same", {"D3", kZ, kX}, {"D3", kZ, kX}, ""},
        Case{"Continuous", {"Cinfv", kZ, kX}, {"Cs", kZ, kX}, ""}),
    [](const auto& each) { return each.param.name; });

TEST(JoinedGroup, NeedsAPointThatBothLeave) {
  const GroupPlacement left = placed({"Cs", kX, kY}, {-0.1, 0, 0});
  EXPECT_FALSE(joined_group(left, placed({"Cs", kX, kY}, {0.1, 0, 0}), Vector3d::Zero(), kTolerance)) << "a row";
  EXPECT_FALSE(joined_group(left, placed({"C2", kZ, kX}, {0.1, 0, 0}), Vector3d::Zero(), kTolerance)) << "a frieze";
  EXPECT_FALSE(joined_group(placed({"C3", kZ, kX}), placed({"C2", kX, kY}, {0, 0.1, 0}), Vector3d::Zero(), kTolerance))
      << "a screw";
}

TEST(JoinedGroup, HasTheCommonPointThatIsNearest) {
  const GroupPlacement mirror = placed({"Cs", kX, kY}, {0.1, 7, 8});
  const GroupPlacement turn = placed({"C2", kZ, kX}, {0.1, -0.2, 9});
  const std::optional<GroupPlacement> joined = joined_group(mirror, turn, {0, 0, 0.3}, kTolerance);
  ASSERT_TRUE(joined);
  EXPECT_LT((joined->centre - Vector3d(0.1, -0.2, 0.3)).norm(), 1e-12);
}

}  // namespace
}  // namespace orbifit

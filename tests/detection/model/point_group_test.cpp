#include "orbifit/model/point_group.h"

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "orbifit/model/annotation.h"

#include "base/random.h"

namespace orbifit {
namespace {

std::vector<std::string> finite_symbols() {
  std::vector<std::string> symbols{"Cs", "Ci", "S4", "S6", "S8", "S10", "S12", "T", "Td", "Th", "O", "Oh", "I", "Ih"};
  for (int n = 2; n <= 13; ++n) {
    const std::string number = std::to_string(n);
    for (const char* suffix : {"", "v", "h"}) symbols.push_back("C" + number + suffix);
    for (const char* suffix : {"", "h", "d"}) symbols.push_back("D" + number + suffix);
  }
  symbols.insert(symbols.end(), {"C64v", "D36h", "D40d"});
  return symbols;
}

class FiniteGroup : public testing::TestWithParam<std::string> {
 protected:
  PointGroup group_ = PointGroup::parse(GetParam()).value();
  GroupFrame frame_ = Random(7, GetParam()).rotation();
};

TEST_P(FiniteGroup, SymbolSurvivesParsing) {
  EXPECT_EQ(group_.symbol(), GetParam());
}

TEST_P(FiniteGroup, HasAsManyElementsAsItsOrderIdentityFirst) {
  const auto all = elements(group_);
  ASSERT_EQ(static_cast<int>(all.size()), group_.order());
  EXPECT_EQ(all.front(), Eigen::Matrix3d(Eigen::Matrix3d::Identity()));
}

TEST_P(FiniteGroup, ProductsAreElementsToRounding) {
  std::vector<Motion> motions;
  for (const Eigen::Matrix3d& linear : elements(group_, frame_)) motions.push_back({linear, Eigen::Vector3d::Zero()});
  EXPECT_TRUE(closed(motions, 1, 4e-15));
}

TEST_P(FiniteGroup, ElementsDiffer) {
  const auto all = elements(group_, frame_);
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) EXPECT_GT((all[i] - all[j]).norm(), 0.01);
  }
}

TEST_P(FiniteGroup, GeneratorsGenerateIt) {
  const auto seeds = generators(group_, frame_);
  std::vector<Eigen::Matrix3d> reached{Eigen::Matrix3d::Identity()};
  for (std::size_t i = 0; i < reached.size(); ++i) {
    ASSERT_LE(reached.size(), static_cast<std::size_t>(group_.order()));
    for (const Eigen::Matrix3d& seed : seeds) {
      const Eigen::Matrix3d product = seed * reached[i];
      bool known = false;
      for (const Eigen::Matrix3d& other : reached) known = known || (other - product).norm() < 1e-6;
      if (!known) reached.push_back(product);
    }
  }
  EXPECT_EQ(static_cast<int>(reached.size()), group_.order());
}

TEST_P(FiniteGroup, IsRecognisedInAnyPoseAndOrder) {
  auto all = elements(group_, frame_);
  std::reverse(all.begin(), all.end());
  const auto found = classify(all);
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->group.symbol(), GetParam());
}

TEST_P(FiniteGroup, WithoutOneElementItIsNoGroup) {
  auto all = elements(group_, frame_);
  all.pop_back();
  const auto found = classify(all);
  // What is left of a group of order 2 is the trivial group.
  EXPECT_EQ(found.has_value() ? found->group.symbol() : "none", group_.order() == 2 ? "C1" : "none");
}

TEST_P(FiniteGroup, IsClosedAboutAnyCentreButNotWithoutAnElementNorWithOneAside) {
  std::vector<Motion> motions;
  const Eigen::Vector3d centre(0.3, -0.2, 0.5);
  for (const Eigen::Matrix3d& linear : elements(group_, frame_)) motions.push_back(Motion::about(linear, centre));
  EXPECT_TRUE(closed(motions, 1, 1e-9));
  std::vector<Motion> aside = motions;
  aside.back().translation[0] += 1e-3;
  EXPECT_EQ(closed(aside, 1, 1e-9), GetParam() == "Ci");  // an inversion is one about any centre
  motions.pop_back();
  EXPECT_EQ(closed(motions, 1, 1e-9), group_.order() == 2);
}

std::string test_name(const testing::TestParamInfo<std::string>& info) {
  return info.param;
}
INSTANTIATE_TEST_SUITE_P(All, FiniteGroup, testing::ValuesIn(finite_symbols()), test_name);

TEST(PointGroup, RefusesWhatIsNoSymbol) {
  for (const char* text :
       {"", "C", "C0", "C01", "Cx", "S3", "S2", "Dv", "C4x", "D3v", "c4", "Th2", "C4v ", "D-2", "C1000001"}) {
    EXPECT_FALSE(PointGroup::parse(text).has_value()) << text;
  }
}

TEST(PointGroup, OrdersGoUpToAMillion) {
  EXPECT_TRUE(PointGroup::parse("C1000000").has_value());
}

// Of two regions on the same faces around a third one, the first.
TEST(SetParents, TakesTheSmallestAroundAndOfEqualOnesTheFirst) {
  std::vector<Region> regions(4);
  for (int i = 0; i < 4; ++i) regions[static_cast<std::size_t>(i)].id = 10 + i;
  regions[0].faces = {0, 1, 2, 3, 4};
  regions[1].faces = {0, 1, 2};
  regions[2].faces = {0, 1, 2};
  regions[3].faces = {1, 2};
  set_parents(regions);
  EXPECT_EQ(regions[0].parent, std::nullopt);
  EXPECT_EQ(regions[1].parent, 10);
  EXPECT_EQ(regions[2].parent, 10);
  EXPECT_EQ(regions[3].parent, 11);
}

TEST(PointGroup, ContinuousGroupsHaveOrderZero) {
  for (const char* text : {"Cinf", "Cinfv", "Cinfh", "Dinf", "Dinfh", "K", "Kh"}) {
    const auto group = PointGroup::parse(text);
    ASSERT_TRUE(group.has_value()) << text;
    EXPECT_TRUE(group->continuous());
    EXPECT_EQ(group->order(), 0);
    EXPECT_EQ(group->symbol(), text);
    EXPECT_FALSE(generators(*group).empty());
  }
}

// Of each kind of orthogonal map that keeps an axis, to which groups about it belong. Source: the groups' definitions.
TEST(PointGroup, ContinuousGroupsHoldWhatKeepsTheirAxisAndSense) {
  Random random(11, "continuous");
  const Eigen::Matrix3d frame = random.rotation();
  const Eigen::Vector3d axis = frame.col(2);
  const Eigen::Matrix3d turn = axis_rotation(axis, 0.7);
  const Eigen::Matrix3d half_turn = axis_rotation(frame.col(0), std::numbers::pi);
  const Eigen::Matrix3d inversion = -Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d upright = inversion * half_turn;
  const Eigen::Matrix3d level = inversion * axis_rotation(axis, std::numbers::pi);
  const struct {
    const char* name;
    Eigen::Matrix3d linear;
    std::string groups;
  } cases[] = {{"turn", turn, "Cinf Cinfv Cinfh Dinf Dinfh K Kh "},
               {"half turn", turn * half_turn, "Dinf Dinfh K Kh "},
               {"upright mirror", turn * upright, "Cinfv Dinfh Kh "},
               {"level mirror", turn * level, "Cinfh Dinfh Kh "},
               {"inversion", inversion, "Cinfh Dinfh Kh "},
               {"tilt", axis_rotation(frame.col(0), 0.1), "K Kh "},
               {"tilted mirror", axis_rotation(frame.col(0), 0.1) * level, "Kh "}};
  for (const auto& one : cases) {
    std::string groups;
    for (const char* text : {"Cinf", "Cinfv", "Cinfh", "Dinf", "Dinfh", "K", "Kh"}) {
      if (belongs_to_continuous(one.linear, *PointGroup::parse(text), axis, 1e-3)) groups += std::string(text) + " ";
    }
    EXPECT_EQ(groups, one.groups) << one.name;
  }
}

// So that products of icosahedral elements are exact to the last digit.
TEST(PointGroup, IcosahedralGeneratorsAreInClosedForm) {
  const double phi = std::numbers::phi;
  for (const Eigen::Matrix3d& generator : generators(*PointGroup::parse("I"))) {
    for (const double entry : generator.reshaped()) {
      const double value = std::abs(entry);
      EXPECT_TRUE(value == 0 || value == 1 || value == 0.5 || value == phi / 2 || value == (phi - 1) / 2) << entry;
    }
  }
}

}  // namespace
}  // namespace orbifit

#include "evidence/chance_symmetry.h"

#include <cmath>
#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "group/verification.h"
#include "shapes.h"

namespace orbifit {
namespace {

// Kinds: six panels (0 to 5), three posts (6 to 8) and a handle (9); each of area 1 but for the handle's.
struct Some {
  const char* name;
  std::vector<int> parts;
  std::vector<std::size_t> expected;

  friend void PrintTo(const Some& some, std::ostream* out) { *out << some.name; }
};

class KindsOfARow : public testing::TestWithParam<Some> {};

TEST_P(KindsOfARow, AreThoseOfWhichThereAreSomeButNotAll) {
  const std::vector<CongruenceClass> kinds{{{0, 1, 2, 3, 4, 5}, {}}, {{6, 7, 8}, {}}, {{9}, {}}};
  std::vector<SurfaceMoments> moments(10);
  for (SurfaceMoments& each : moments) each.area = 1;
  moments[9].area = 3;
  EXPECT_EQ(kinds_of_a_row(GetParam().parts, kinds, moments), GetParam().expected);
}

INSTANTIATE_TEST_SUITE_P(Parts, KindsOfARow,
                         testing::Values(Some{"Two", {1, 2}, {0}}, Some{"Five", {0, 1, 2, 3, 4}, {0}},
                                         Some{"One", {3}, {}}, Some{"All", {0, 1, 2, 3, 4, 5}, {}},
                                         Some{"TwoAndAPost", {1, 2, 7}, {0}},
                                         Some{"TwoAndMoreOfAHandle", {1, 2, 9}, {}},
                                         Some{"FourAndAHandle", {1, 2, 3, 4, 9}, {0}},
                                         Some{"PostsAreTooFew", {6, 7}, {}}),
                         [](const auto& each) { return std::string(each.param.name); });

// Kinds: twelve studs (0 to 11) and four posts (12 to 15), each of area 1, and a plate (16) of area 4.
struct OfAGrid {
  const char* name;
  const char* group;
  std::vector<int> parts;
  bool expected;

  friend void PrintTo(const OfAGrid& some, std::ostream* out) { *out << some.name; }
};

class SomeOfAGrid : public testing::TestWithParam<OfAGrid> {};

TEST_P(SomeOfAGrid, HasMirrorsAndHalfTurnsByChance) {
  const std::vector<CongruenceClass> kinds{
      {{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}, {}}, {{12, 13, 14, 15}, {}}, {{16}, {}}};
  std::vector<SurfaceMoments> moments(17);
  for (SurfaceMoments& each : moments) each.area = 1;
  moments[16].area = 4;
  EXPECT_EQ(some_of_a_grid(*PointGroup::parse(GetParam().group), GetParam().parts, kinds, moments),
            GetParam().expected);
}

INSTANTIATE_TEST_SUITE_P(Parts, SomeOfAGrid,
                         testing::Values(OfAGrid{"Mirror", "Cs", {0, 1, 2, 5, 6, 7}, true},
                                         OfAGrid{"HalfTurn", "C2", {0, 1, 2, 5, 6, 7}, true},
                                         OfAGrid{"BothAndAPost", "D2h", {0, 1, 2, 3, 4, 5, 6, 7, 12}, true},
                                         OfAGrid{"RingOfSix", "C6v", {0, 1, 2, 5, 6, 7}, false},
                                         OfAGrid{"Continuous", "Cinfv", {0, 1, 2, 5, 6, 7}, false},
                                         OfAGrid{"FourAreFew", "C2v", {0, 1, 2, 3}, false},
                                         OfAGrid{"TenAreNearlyAll", "C2v", {0, 1, 2, 3, 4, 5, 6, 7, 8, 9}, false},
                                         OfAGrid{"ThePlateIsMore", "Cs", {0, 1, 2, 5, 6, 7, 16}, false},
                                         OfAGrid{"PostsAreNoGrid", "C2v", {12, 13, 14, 15}, false}),
                         [](const auto& each) { return std::string(each.param.name); });

// What a mirror keeps of hills that are odd in x by waves of some height: all where there are none, else up to where
// they differ by the tolerance.
class MirroredHills : public testing::TestWithParam<double> {
 protected:
  MirroredHills() {
    const Similarity& input = prepared_.input_of_normalised;
    mirror_ = {*PointGroup::parse("Cs"), frame_about(Eigen::Vector3d::UnitX()), -input.translation / input.scale};
    const Points& vertices = prepared_.mesh.vertices;
    for (int f = 0; f < prepared_.mesh.faces.rows(); ++f) {
      double x = 0;
      for (int k = 0; k < 3; ++k) x += (vertices(prepared_.mesh.faces(f, k), 0) - mirror_.centre.x()) * input.scale / 3;
      if (2 * GetParam() * std::abs(std::sin(9 * x)) < test::kTolerance * input.scale) kept_.push_back(f);
    }
  }

  PreparedMesh prepared_ = prepare(test::hills(80, GetParam()));
  GroupPlacement mirror_;
  std::vector<int> kept_;
};

TEST_P(MirroredHills, FadeWhereTheirWavesAreCutOffByTheTolerance) {
  const SurfacePatch patch = make_patch(prepared_, kept_, 1000, test::kTolerance, {}, "test");
  EXPECT_TRUE(passes(verify_group(patch, mirror_, {}), {.joint = 0.9, .worst = 0.9, .cluster = 1, .part = 0}));
  EXPECT_EQ(fades(patch, mirror_, {}), GetParam() > 0);
}

INSTANTIATE_TEST_SUITE_P(Waves, MirroredHills, testing::Values(0, 0.005, 0.01, 0.02), [](const auto& each) {
  return "PerMille" + std::to_string(static_cast<int>(std::lround(1000 * each.param)));
});

}  // namespace
}  // namespace orbifit

#include "chance_symmetry.h"

#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace orbifit

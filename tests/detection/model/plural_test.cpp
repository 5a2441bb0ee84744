#include "base/plural.h"

#include <gtest/gtest.h>

namespace orbifit {
namespace {

struct Name {
  const char *one, *many;
};

class Plural : public testing::TestWithParam<Name> {};

TEST_P(Plural, IsEnglish) {
  EXPECT_EQ(plural(GetParam().one), GetParam().many);
}

INSTANTIATE_TEST_SUITE_P(Names, Plural,
                         testing::Values(Name{"leg", "legs"}, Name{"foot", "feet"}, Name{"gear tooth", "gear teeth"},
                                         Name{"box", "boxes"}, Name{"brush", "brushes"}, Name{"body", "bodies"},
                                         Name{"tray", "trays"}, Name{"bar of door", "bars of door"},
                                         Name{"group of 4 x foot", "groups of 4 x foot"}, Name{"y", "ys"},
                                         Name{"glass", "glasses"}, Name{"", ""}, Name{"Cube.003", "Cube.003"}));

}  // namespace
}  // namespace orbifit

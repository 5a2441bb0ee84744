#include "geometry/side_order.h"

#include <algorithm>
#include <array>
#include <vector>

#include <gtest/gtest.h>

#include "base/random.h"

namespace orbifit {
namespace {

struct Numbered {
  std::array<int, 2> ends;
  int number;

  bool operator==(const Numbered&) const = default;
};

class SortByEnds : public testing::TestWithParam<std::array<std::size_t, 2>> {};

TEST_P(SortByEnds, IsAStableSort) {
  const auto [count, points] = GetParam();
  Random random(3, "sides");
  std::vector<Numbered> sides;
  for (std::size_t i = 0; i < count; ++i) {
    const auto end = [&] { return static_cast<int>(random.below(points)); };
    sides.push_back({{end(), end()}, static_cast<int>(i)});
  }
  std::vector<Numbered> expected = sides;
  std::ranges::stable_sort(expected, {}, &Numbered::ends);
  sort_by_ends(sides, points, &Numbered::ends);
  EXPECT_EQ(sides, expected);
}

INSTANTIATE_TEST_SUITE_P(Sides, SortByEnds,
                         testing::Values(std::array<std::size_t, 2>{0, 0}, std::array<std::size_t, 2>{1, 1},
                                         std::array<std::size_t, 2>{50, 3}, std::array<std::size_t, 2>{1000, 40},
                                         std::array<std::size_t, 2>{100, 5000}));

}  // namespace
}  // namespace orbifit

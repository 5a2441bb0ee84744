#include "orbifit/apps/chart.h"

#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "count.h"

namespace orbifit {
namespace {

// Centres of the marks, but for those of the legend.
std::vector<std::pair<double, double>> marks(const std::string& svg) {
  std::vector<std::pair<double, double>> result;
  const std::string start = "<circle cx=\"";
  for (std::size_t at = svg.find(start); at != std::string::npos; at = svg.find(start, at + 1)) {
    const double x = std::stod(svg.substr(at + start.size()));
    const std::size_t y = svg.find("cy=\"", at) + 4;
    if (svg.substr(svg.find("r=\"", y), 6) == "r=\"3\" ") result.emplace_back(x, std::stod(svg.substr(y)));
  }
  return result;
}

TEST(ToSvg, StandsPowersOfTenAtEqualDistances) {
  const Chart chart{"t", "x", "y", {{"line", {{1, 100}, {10, 10}, {100, 1}}, -1}}};
  const auto at = marks(to_svg(chart));
  ASSERT_EQ(at.size(), 3U);
  EXPECT_NEAR(at[1].first - at[0].first, at[2].first - at[1].first, 0.11);
  EXPECT_NEAR(at[1].second - at[0].second, at[2].second - at[1].second, 0.11);
  EXPECT_LT(at[0].first, at[1].first);
  EXPECT_LT(at[0].second, at[1].second);  // more is higher up
}

TEST(ToSvg, LeavesOutWhatALogarithmHasNotAndEscapesNames) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Chart chart{"a < b", "x & y", "\"z\"", {{"<b>", {{1, 0}, {-1, 2}, {3, nan}, {2, 5}}, 0}, {"empty", {}, 1}}};
  const std::string svg = to_svg(chart);
  EXPECT_EQ(marks(svg).size(), 1U);
  EXPECT_EQ(count(svg, "<b>"), 0U);
  EXPECT_EQ(count(svg, "&lt;b&gt;"), 1U);
  EXPECT_EQ(count(svg, "nan"), 0U);
  EXPECT_EQ(svg, to_svg(chart));
}

TEST(ToSvg, GivesANumberedColourToEachSeriesThatAsksForIt) {
  const auto colour = [](int number, int place) {
    Chart chart{"t", "x", "y", {}};
    for (int i = 0; i <= place; ++i) chart.series.push_back({"s", {{1, 1}}, i == place ? number : 7});
    const std::string svg = to_svg(chart);
    const std::size_t at = svg.rfind("fill=\"#", svg.rfind("<text")) + 6;
    return svg.substr(at, 7);
  };
  EXPECT_EQ(colour(2, 0), colour(2, 3));
  EXPECT_NE(colour(2, 0), colour(3, 0));
}

}  // namespace
}  // namespace orbifit

#include "lettering.h"

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "stroke_font.h"

namespace orbifit {
namespace {

Image paper(int width = 200, int height = 40) {
  return {width, height, std::vector<std::uint8_t>(static_cast<std::size_t>(3 * width * height), 255)};
}

Image written(const std::string& text, double capitals = 14) {
  Image image = paper();
  draw_text(image, 4, 26, text, {capitals, 1.6, {0, 0, 0}});
  return image;
}

int ink_in(const Image& image, int top, int bottom) {
  int count = 0;
  for (int y = top; y < bottom; ++y) {
    for (int x = 0; x < image.width; ++x) {
      count += image.rgb[static_cast<std::size_t>(3 * (y * image.width + x))] < 128 ? 1 : 0;
    }
  }
  return count;
}

TEST(StrokeFont, DrawsEveryPrintableLetterOfAsciiInItsOwnWay) {
  const Glyph box = glyphs_of("\xF0\x9F\x98\x80").front();
  std::set<std::vector<std::uint8_t>> seen;
  for (char c = '!'; c <= '~'; ++c) {
    const std::vector<Glyph> glyphs = glyphs_of(std::string(1, c));
    ASSERT_EQ(glyphs.size(), 1U);
    EXPECT_FALSE(glyphs[0].strokes.empty()) << c;
    EXPECT_NE(glyphs[0].strokes, box.strokes) << c;
    for (const auto& stroke : glyphs[0].strokes) {
      for (const Eigen::Vector2d& point : stroke) {
        EXPECT_GT(point.x(), 0) << c;
        EXPECT_LT(point.x(), glyphs[0].advance) << c;
        EXPECT_GT(point.y(), -5) << c;
        EXPECT_LT(point.y(), 17) << c;
      }
    }
    EXPECT_TRUE(seen.insert(written(std::string(1, c)).rgb).second) << c;
  }
}

TEST(StrokeFont, ReadsUtf8) {
  EXPECT_EQ(glyphs_of("3 × ∞").size(), 5U);
  EXPECT_NE(glyphs_of("×")[0].strokes, glyphs_of("∞")[0].strokes);
  EXPECT_EQ(glyphs_of("ж")[0].strokes, glyphs_of("中")[0].strokes);  // boxes
  EXPECT_EQ(glyphs_of("\xFF\xC3").size(), 2U);                       // no UTF-8, no harm
}

TEST(Lettering, StandsOnItsBaseline) {
  const Image capital = written("H");
  EXPECT_GT(ink_in(capital, 12, 27), 20);
  EXPECT_EQ(ink_in(capital, 0, 11) + ink_in(capital, 28, 40), 0);
  EXPECT_GT(ink_in(written("p"), 28, 40), 0);  // descends
}

// Edges are grey: a bitmap font's are not.
TEST(Lettering, IsSmooth) {
  const Image image = written("Oo");
  const auto grey = std::ranges::count_if(image.rgb, [](std::uint8_t v) { return v > 40 && v < 215; });
  EXPECT_GT(grey, 60);
}

TEST(Lettering, IsAsWideAsItSays) {
  const Lettering lettering{14, 1.6, {0, 0, 0}};
  const Image image = written("seat and legs");
  int last = 0;
  for (int i = 0; i < image.width * image.height; ++i) {
    if (image.rgb[static_cast<std::size_t>(3 * i)] < 128) last = std::max(last, i % image.width);
  }
  EXPECT_NEAR(last, 4 + text_width("seat and legs", lettering), 4);
}

TEST(Lettering, CutsWhatDoesNotFit) {
  const Lettering lettering;
  EXPECT_EQ(fitted_text("seat", 1000, lettering), "seat");
  const std::string cut = fitted_text("a name that is ×××××× too long", 100, lettering);
  EXPECT_TRUE(cut.ends_with("…"));
  EXPECT_LE(text_width(cut, lettering), 100);
  Image image = paper(30, 20);
  draw_text(image, -20, 15, "runs out of the picture", lettering);  // no harm
  EXPECT_EQ(image.rgb.size(), 1800U);
}

}  // namespace
}  // namespace orbifit

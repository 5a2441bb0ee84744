#include "stroke_font.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <sstream>

namespace orbifit {

namespace {

// A pen of constant width and round end draws each letter, so a picture needs no font of the machine that makes it.
// "M x y" begins a stroke, "L x y" goes on to a point, "A x y rx ry from to" goes on along an ellipse about (x, y)
// between two angles in degrees, counter-clockwise where they grow; "O x y rx ry" is a whole ellipse and "D x y" a dot.
struct Drawing {
  char32_t letter;
  double advance;
  const char* path;
};

constexpr Drawing kBox{U'\0', 11, "M 2 0 L 2 14 L 9 14 L 9 0 L 2 0"};

constexpr std::array kDrawings{
    Drawing{U' ', 5, ""},
    Drawing{U'!', 4, "M 2 14 L 2 4.2 D 2 0.1"},
    Drawing{U'"', 7.4, "M 2 14 L 2 10.4 M 5.4 14 L 5.4 10.4"},
    Drawing{U'#', 13, "M 5 14 L 3 0 M 10 14 L 8 0 M 1.4 9.4 L 12 9.4 M 1 4.6 L 11.6 4.6"},
    Drawing{U'$', 11.2, "M 5.6 16 L 5.6 -2 M 9 11.6 A 5.6 10.5 3.8 3.5 25 270 A 5.6 3.5 4.2 3.5 90 -155"},
    Drawing{U'%', 15.2, "O 4 10.6 2.6 3.3 O 11.2 3.4 2.6 3.3 M 11.4 14 L 3.8 0"},
    Drawing{U'&', 13.6, "M 12 0 L 3.5 9.3 A 5.9 11.3 2.9 2.7 220 -40 L 3.2 6.4 A 5.4 3.6 3.9 3.6 130 300 L 11.6 7"},
    Drawing{U'\'', 4, "M 2 14 L 2 10.4"},
    Drawing{U'(', 5.4, "A 7 5.4 5 10.4 125 235"},
    Drawing{U')', 5.4, "A -1.6 5.4 5 10.4 55 -55"},
    Drawing{U'*', 8.8, "M 4.4 14 L 4.4 7.6 M 1.6 12.4 L 7.2 9.2 M 7.2 12.4 L 1.6 9.2"},
    Drawing{U'+', 11, "M 1.6 6.6 L 9.4 6.6 M 5.5 2.7 L 5.5 10.5"},
    Drawing{U',', 4, "M 2.3 0.5 L 1.3 -2.8"},
    Drawing{U'-', 6.6, "M 1.4 5.2 L 5.2 5.2"},
    Drawing{U'.', 4, "D 2 0.1"},
    Drawing{U'/', 7, "M 0.8 -2 L 6.2 15.4"},
    Drawing{U'0', 11, "O 5.5 7 3.9 7"},
    Drawing{U'1', 11, "M 2.8 11.2 L 6.2 14 L 6.2 0"},
    Drawing{U'2', 11, "M 1.8 11.2 A 5.4 10.2 3.7 3.8 165 -38 L 1.8 0 L 9.4 0"},
    Drawing{U'3', 11, "M 2.2 12.2 A 5.2 10.6 3.5 3.4 150 -90 L 4.4 7.2 M 5.2 7.2 A 5.2 3.6 4 3.6 90 -150"},
    Drawing{U'4', 11, "M 7.5 0 L 7.5 14 L 1.4 4 L 9.8 4"},
    Drawing{U'5', 11, "M 8.6 14 L 2.9 14 L 2.3 7.4 A 5.2 4.5 4.1 4.5 140 -150"},
    Drawing{U'6', 11, "M 7.6 14 L 2.3 6.7 M 9.5 4.4 O 5.5 4.5 3.9 4.5"},
    Drawing{U'7', 11, "M 1.6 14 L 9.4 14 L 4 0"},
    Drawing{U'8', 11, "O 5.5 10.6 3.4 3.4 O 5.5 3.6 3.9 3.6"},
    Drawing{U'9', 11, "M 3.4 0 L 8.7 7.3 O 5.5 9.5 3.9 4.5"},
    Drawing{U':', 4, "D 2 0.1 D 2 8.4"},
    Drawing{U';', 4, "D 2 8.4 M 2.3 0.5 L 1.3 -2.8"},
    Drawing{U'<', 11, "M 9 11 L 1.8 6.6 L 9 2.2"},
    Drawing{U'=', 11, "M 1.6 8.6 L 9.4 8.6 M 1.6 4.6 L 9.4 4.6"},
    Drawing{U'>', 11, "M 2 11 L 9.2 6.6 L 2 2.2"},
    Drawing{U'?', 9.4, "M 1.6 11.2 A 4.8 10.3 3.2 3.7 165 -45 A 6.6 5.4 2 2.4 150 180 L 4.6 4.2 D 4.6 0.1"},
    Drawing{U'@', 16.4, "O 8.2 5.6 3 3.6 M 11.2 9.2 L 11.2 4.4 A 12.8 4.4 1.6 2.2 180 300 A 8.2 5.8 6.7 7.6 -8 300"},
    Drawing{U'A', 12, "M 0.8 0 L 6 14 L 11.2 0 M 2.6 4.8 L 9.4 4.8"},
    Drawing{U'B', 11.6, "M 6 7.4 L 2 7.4 L 2 14 L 6 14 A 6 10.7 3.3 3.3 90 -90 A 6 3.7 3.9 3.7 90 -90 L 2 0 L 2 7.4"},
    Drawing{U'C', 12.6, "A 7.2 7 5.6 7 47 313"},
    Drawing{U'D', 13, "M 2 0 L 2 14 L 5.4 14 A 5.4 7 5.9 7 90 -90 L 2 0"},
    Drawing{U'E', 10.4, "M 9 14 L 2 14 L 2 0 L 9.2 0 M 2 7.3 L 8.2 7.3"},
    Drawing{U'F', 9.6, "M 8.8 14 L 2 14 L 2 0 M 2 7 L 8 7"},
    Drawing{U'G', 14, "A 7.2 7 5.6 7 47 335 L 12.4 6.6 L 7.8 6.6"},
    Drawing{U'H', 13, "M 2 14 L 2 0 M 11 14 L 11 0 M 2 7.3 L 11 7.3"},
    Drawing{U'I', 4, "M 2 14 L 2 0"},
    Drawing{U'J', 9, "M 7 14 L 7 4 A 4 4 3 4 0 -160"},
    Drawing{U'K', 11.4, "M 2 14 L 2 0 M 10 14 L 2 5.4 M 4.8 8.4 L 10.6 0"},
    Drawing{U'L', 9.4, "M 2 14 L 2 0 L 8.6 0"},
    Drawing{U'M', 15, "M 2 0 L 2 14 L 7.5 3.6 L 13 14 L 13 0"},
    Drawing{U'N', 13, "M 2 0 L 2 14 L 11 0 L 11 14"},
    Drawing{U'O', 14.6, "O 7.3 7 5.7 7"},
    Drawing{U'P', 11, "M 2 0 L 2 14 L 6 14 A 6 10.2 3.8 3.8 90 -90 L 2 6.4"},
    Drawing{U'Q', 14.6, "O 7.3 7 5.7 7 M 8.8 3.4 L 12.8 -0.8"},
    Drawing{U'R', 11.6, "M 2 0 L 2 14 L 6 14 A 6 10.2 3.8 3.8 90 -90 L 2 6.4 M 6 6.4 L 10.4 0"},
    Drawing{U'S', 11.2, "A 5.6 10.5 3.8 3.5 35 270 A 5.6 3.5 4.2 3.5 90 -150"},
    Drawing{U'T', 11.2, "M 0.8 14 L 10.4 14 M 5.6 14 L 5.6 0"},
    Drawing{U'U', 12.8, "M 2 14 L 2 4.6 A 6.4 4.6 4.4 4.6 180 360 L 10.8 14"},
    Drawing{U'V', 12, "M 0.8 14 L 6 0 L 11.2 14"},
    Drawing{U'W', 17.6, "M 0.8 14 L 4.8 0 L 8.8 13 L 12.8 0 L 16.8 14"},
    Drawing{U'X', 11.6, "M 1.2 14 L 10.4 0 M 10.4 14 L 1.2 0"},
    Drawing{U'Y', 11.6, "M 0.8 14 L 5.8 6.6 L 10.8 14 M 5.8 6.6 L 5.8 0"},
    Drawing{U'Z', 11.4, "M 1.4 14 L 10 14 L 1.4 0 L 10 0"},
    Drawing{U'[', 5.4, "M 4.6 15 L 2 15 L 2 -4 L 4.6 -4"},
    Drawing{U'\\', 7, "M 0.8 15.4 L 6.2 -2"},
    Drawing{U']', 5.4, "M 0.8 15 L 3.4 15 L 3.4 -4 L 0.8 -4"},
    Drawing{U'^', 9.4, "M 1.6 9 L 4.7 14 L 7.8 9"},
    Drawing{U'_', 10, "M 0.4 -2.4 L 9.6 -2.4"},
    Drawing{U'`', 5, "M 1.4 14.4 L 3.4 11.8"},
    Drawing{
        U'a', 10.6,
        "M 8.6 0 L 8.6 6.2 A 5.3 6.2 3.3 3.8 0 150 M 8.6 5.8 L 5 5.8 A 5 2.9 3.3 2.9 90 270 A 5 3.2 3.6 3.2 270 360"},
    Drawing{U'b', 11, "M 2 15 L 2 0 O 5.6 5 3.6 5"},
    Drawing{U'c', 9.4, "A 5.4 5 3.9 5 45 315"},
    Drawing{U'd', 11, "M 9 15 L 9 0 O 5.4 5 3.6 5"},
    Drawing{U'e', 10.4, "M 1.6 5.3 L 8.9 5.3 A 5.2 5 3.7 5 4 316"},
    Drawing{U'f', 6.2, "M 2.6 0 L 2.6 12 A 5.6 12 3 3 180 75 M 0.6 10 L 5.6 10"},
    Drawing{U'g', 11, "O 5.4 5 3.6 5 M 9 10 L 9 -0.6 A 5.5 -0.6 3.5 3.9 0 -145"},
    Drawing{U'h', 10.4, "M 2 15 L 2 0 M 2 6 A 5.2 6 3.2 4 180 0 L 8.4 0"},
    Drawing{U'i', 4, "M 2 10 L 2 0 D 2 13.9"},
    Drawing{U'j', 4.4, "M 2.4 10 L 2.4 -2 A 0 -2 2.4 2.5 0 -80 D 2.4 13.9"},
    Drawing{U'k', 9.2, "M 2 15 L 2 0 M 8 10 L 2 3.8 M 4.2 6.1 L 8.4 0"},
    Drawing{U'l', 4, "M 2 15 L 2 0"},
    Drawing{U'm', 15.2,
            "M 2 10 L 2 0 M 2 6.4 A 4.8 6.4 2.8 3.6 180 0 L 7.6 0 M 7.6 6.4 A 10.4 6.4 2.8 3.6 180 0 L 13.2 0"},
    Drawing{U'n', 10.4, "M 2 10 L 2 0 M 2 6 A 5.2 6 3.2 4 180 0 L 8.4 0"},
    Drawing{U'o', 10.8, "O 5.4 5 3.8 5"},
    Drawing{U'p', 11, "M 2 10 L 2 -4.5 O 5.6 5 3.6 5"},
    Drawing{U'q', 11, "M 9 10 L 9 -4.5 O 5.4 5 3.6 5"},
    Drawing{U'r', 6.6, "M 2 10 L 2 0 M 2 5.6 A 5.4 5.8 3.4 4.2 180 80"},
    Drawing{U's', 8.8, "A 4.4 7.5 2.8 2.5 35 270 A 4.4 2.5 3.1 2.5 90 -150"},
    Drawing{U't', 6.6, "M 2.8 13.2 L 2.8 3 A 5.4 3 2.6 3 180 285 M 0.6 10 L 6 10"},
    Drawing{U'u', 10.4, "M 2 10 L 2 4 A 5.2 4 3.2 4 180 360 M 8.4 10 L 8.4 0"},
    Drawing{U'v', 9.6, "M 1 10 L 4.8 0 L 8.6 10"},
    Drawing{U'w', 14, "M 1 10 L 4 0 L 7 9 L 10 0 L 13 10"},
    Drawing{U'x', 9.4, "M 1.3 10 L 8.1 0 M 8.1 10 L 1.3 0"},
    Drawing{U'y', 9.6, "M 1 10 L 5 0.2 M 8.6 10 L 4.4 -1.6 A 1.8 -1.2 2.7 3.2 -20 -85"},
    Drawing{U'z', 9.2, "M 1.4 10 L 7.8 10 L 1.4 0 L 7.8 0"},
    Drawing{U'{', 6.4,
            "M 5.4 15 A 5 12.6 2 2.4 90 180 L 3 8 A 1 8 2 2.5 0 -90 A 1 3 2 2.5 90 0 L 3 -1.6 A 5 -1.6 2 2.4 180 270"},
    Drawing{U'|', 5, "M 2.5 15.4 L 2.5 -4.5"},
    Drawing{U'}', 6.4,
            "M 1 15 A 1.4 12.6 2 2.4 90 0 L 3.4 8 A 5.4 8 2 2.5 180 270 A 5.4 3 2 2.5 90 180 L 3.4 -1.6 A 1.4 -1.6 2 "
            "2.4 0 -90"},
    Drawing{U'~', 11, "M 1.6 5.6 A 3.5 6 2 1.8 180 20 A 7.5 7 2 1.8 200 360"},
    Drawing{U'°', 6.4, "O 3.2 12 2 2.1"},
    Drawing{U'±', 11, "M 1.6 7.6 L 9.4 7.6 M 5.5 4 L 5.5 11.2 M 1.6 1 L 9.4 1"},
    Drawing{U'·', 4, "D 2 5.2"},
    Drawing{U'×', 11, "M 2.4 9.7 L 8.6 3.5 M 8.6 9.7 L 2.4 3.5"},
    Drawing{U'–', 10, "M 1 5.2 L 9 5.2"},
    Drawing{U'…', 12, "D 2 0.1 D 6 0.1 D 10 0.1"},
    Drawing{U'∞', 16, "O 4.6 5.4 3.2 3 O 11.4 5.4 3.6 3.4"},
    Drawing{U'≤', 11, "M 9 12 L 1.8 8 L 9 4 M 1.8 1 L 9 1"},
};

Glyph drawn(const Drawing& drawing) {
  constexpr double kStep = 12;  // degrees between the points of an arc
  constexpr double kDegree = std::numbers::pi / 180;
  constexpr double kTracking = 0.7;  // font units between letters: captions are small
  Glyph glyph;
  glyph.advance = drawing.advance + kTracking;
  std::istringstream path(drawing.path);
  bool pen_down = false;
  const auto go_to = [&](double x, double y) {
    if (!pen_down) glyph.strokes.emplace_back();
    pen_down = true;
    glyph.strokes.back().emplace_back(x, y);
  };
  for (char command = 0; path >> command;) {
    double x = 0, y = 0, rx = 0, ry = 0, from = 0, to = 360;
    path >> x >> y;
    if (command == 'A' || command == 'O') path >> rx >> ry;
    if (command == 'A') path >> from >> to;
    if (command != 'L' && command != 'A') pen_down = false;
    if (command == 'M' || command == 'L' || command == 'D') {
      go_to(x, y);
    } else {
      const int steps = std::max(1, static_cast<int>(std::ceil(std::abs(to - from) / kStep)));
      for (int i = 0; i <= steps; ++i) {
        const double angle = kDegree * (from + (to - from) * i / steps);
        go_to(x + rx * std::cos(angle), y + ry * std::sin(angle));
      }
    }
    if (command == 'O' || command == 'D') pen_down = false;
  }
  return glyph;
}

// The code points of UTF-8; bytes that are none stand for themselves, so that a box shows them.
std::vector<char32_t> letters_of(const std::string& text) {
  std::vector<char32_t> result;
  for (std::size_t i = 0; i < text.size();) {
    const auto lead = static_cast<unsigned char>(text[i]);
    const int more = lead >= 0xF0 ? 3 : lead >= 0xE0 ? 2 : lead >= 0xC0 ? 1 : 0;
    char32_t letter = more == 0 ? lead : lead & (0x3FU >> static_cast<unsigned>(more));
    std::size_t next = i + 1;
    for (int k = 0; k < more && next < text.size() && (static_cast<unsigned char>(text[next]) & 0xC0U) == 0x80U; ++k) {
      letter = letter << 6U | (static_cast<unsigned char>(text[next++]) & 0x3FU);
    }
    result.push_back(letter);
    i = next;
  }
  return result;
}

}  // namespace

std::vector<Glyph> glyphs_of(const std::string& text) {
  std::vector<Glyph> result;
  for (const char32_t letter : letters_of(text)) {
    const auto* const found = std::ranges::find(kDrawings, letter, &Drawing::letter);
    result.push_back(drawn(found == kDrawings.end() ? kBox : *found));
  }
  return result;
}

double width_of(const std::vector<Glyph>& glyphs) {
  double width = 0;
  for (const Glyph& glyph : glyphs) width += glyph.advance;
  return width;
}

}  // namespace orbifit

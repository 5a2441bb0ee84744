#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace orbifit {

/// A letter as a pen draws it: polylines in font units, y up from the baseline. Capitals are 14 units high, small
/// letters 10, with 4.5 below the line.
struct Glyph {
  double advance = 0;  ///< from this letter's origin to the next one's
  std::vector<std::vector<Eigen::Vector2d>> strokes;
};

constexpr double kCapitalHeight = 14;  ///< font units

/// The glyphs of a UTF-8 text, one a letter. A letter that the font does not have is an empty box.
std::vector<Glyph> glyphs_of(const std::string& text);

/// The sum of their advances, in font units.
double width_of(const std::vector<Glyph>& glyphs);

}  // namespace orbifit

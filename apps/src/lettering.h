#pragma once

#include <string>

#include <Eigen/Core>

#include "orbifit/apps/render.h"

namespace orbifit {

/// How large and how heavy a text is drawn, in pixels.
struct Lettering {
  double capitals = 11;  ///< height of a capital letter
  double pen = 1.5;      ///< width of the strokes
  Colour colour{0.12F, 0.14F, 0.18F};
};

/// Pixels that a UTF-8 text takes up from its begin to its end.
double text_width(const std::string& text, const Lettering& lettering);

/// The text, or as much of its begin as fits, with an ellipsis then. \param width  pixels
std::string fitted_text(const std::string& text, double width, const Lettering& lettering);

/// Draws a text on one line, anti-aliased; what lies outside of the image is left out.
/// \param x, y  pixels: where the text begins, on its baseline
void draw_text(Image& image, double x, double y, const std::string& text, const Lettering& lettering);

/// Draws a straight line, anti-aliased. \param from, to  pixels \param pen  its width
void draw_line(Image& image, const Eigen::Vector2d& from, const Eigen::Vector2d& to, double pen, const Colour& colour);

}  // namespace orbifit

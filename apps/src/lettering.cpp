#include "lettering.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "stroke_font.h"

namespace orbifit {

namespace {

double distance_to_segment(const Eigen::Vector2d& point, const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  const Eigen::Vector2d along = to - from;
  const double length = along.squaredNorm();
  const double share = length > 0 ? std::clamp((point - from).dot(along) / length, 0.0, 1.0) : 0;
  return (point - from - share * along).norm();
}

/// How much of each pixel the strokes of one letter cover: where strokes cross, the ink is no darker.
class Ink {
 public:
  Ink(const Image& image, double pen) : image_(image), half_pen_(0.5 * pen) {
    cover_.assign(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height), 0.0F);
  }

  void stroke(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
    const double reach = half_pen_ + 1;
    const auto first = [](double a, double b, double by) {
      return std::max(0, static_cast<int>(std::floor(std::min(a, b) - by)));
    };
    const auto end = [](double a, double b, double by, int most) {
      return std::min(most, static_cast<int>(std::ceil(std::max(a, b) + by)));
    };
    for (int v = first(from.y(), to.y(), reach); v < end(from.y(), to.y(), reach, image_.height); ++v) {
      for (int u = first(from.x(), to.x(), reach); u < end(from.x(), to.x(), reach, image_.width); ++u) {
        const double distance = distance_to_segment({u + 0.5, v + 0.5}, from, to);
        float& cover = cover_[place(u, v)];
        cover = std::max(cover, static_cast<float>(std::clamp(half_pen_ - distance + 0.5, 0.0, 1.0)));
      }
    }
  }

  void blend_onto(Image& image, const Colour& colour) const {
    for (std::size_t i = 0; i < cover_.size(); ++i) {
      if (cover_[i] <= 0) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        std::uint8_t& target = image.rgb[3 * i + k];
        const float ink = 255 * colour[static_cast<Eigen::Index>(k)];
        target = static_cast<std::uint8_t>(std::lround((1 - cover_[i]) * static_cast<float>(target) + cover_[i] * ink));
      }
    }
  }

 private:
  std::size_t place(int u, int v) const {
    return static_cast<std::size_t>(v) * static_cast<std::size_t>(image_.width) + static_cast<std::size_t>(u);
  }

  const Image& image_;
  double half_pen_;
  std::vector<float> cover_;
};

// Cut between letters, not within one.
void drop_last_letter(std::string& text) {
  while (!text.empty() && (static_cast<unsigned char>(text.back()) & 0xC0U) == 0x80U) text.pop_back();
  if (!text.empty()) text.pop_back();
}

}  // namespace

double text_width(const std::string& text, const Lettering& lettering) {
  return lettering.capitals / kCapitalHeight * width_of(glyphs_of(text));
}

std::string fitted_text(const std::string& text, double width, const Lettering& lettering) {
  if (text_width(text, lettering) <= width) return text;
  std::string result = text;
  while (!result.empty() && text_width(result + "…", lettering) > width) drop_last_letter(result);
  return result + "…";
}

void draw_text(Image& image, double x, double y, const std::string& text, const Lettering& lettering) {
  const double scale = lettering.capitals / kCapitalHeight;
  Ink ink(image, lettering.pen);
  Eigen::Vector2d origin(x, y);
  for (const Glyph& glyph : glyphs_of(text)) {
    const auto in_image = [&](const Eigen::Vector2d& point) -> Eigen::Vector2d {
      return origin + scale * Eigen::Vector2d(point.x(), -point.y());
    };
    for (const auto& stroke : glyph.strokes) {
      if (stroke.size() == 1) {  // a dot is a little larger than the pen
        const Eigen::Vector2d middle = in_image(stroke.front());
        const Eigen::Vector2d half(0.15 * lettering.pen, 0);
        ink.stroke(middle - half, middle + half);
      }
      for (std::size_t i = 0; i + 1 < stroke.size(); ++i) ink.stroke(in_image(stroke[i]), in_image(stroke[i + 1]));
    }
    origin.x() += scale * glyph.advance;
  }
  ink.blend_onto(image, lettering.colour);
}

void draw_line(Image& image, const Eigen::Vector2d& from, const Eigen::Vector2d& to, double pen, const Colour& colour) {
  Ink ink(image, pen);
  ink.stroke(from, to);
  ink.blend_onto(image, colour);
}

}  // namespace orbifit

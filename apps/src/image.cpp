#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "orbifit/apps/render.h"
#include "orbifit/model/errors.h"

#include "files/file.h"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wold-style-cast"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#pragma GCC diagnostic ignored "-Wunused-function"
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb/stb_easy_font.h>
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

namespace orbifit {

namespace {

constexpr int kTextScale = 2;
constexpr int kGap = 12;
constexpr int kCaptionHeight = 34;
constexpr std::array<int, 3> kInk{45, 48, 54};

std::uint8_t* pixel(Image& image, int x, int y) {
  return &image.rgb[3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                         static_cast<std::size_t>(x))];
}

// One rectangle of ink; the parts of pixels that it covers are blended.
void fill(Image& image, float left, float top, float right, float bottom) {
  const int first_x = std::max(0, static_cast<int>(left));
  const int first_y = std::max(0, static_cast<int>(top));
  for (int y = first_y; y < std::min(image.height, static_cast<int>(bottom) + 1); ++y) {
    for (int x = first_x; x < std::min(image.width, static_cast<int>(right) + 1); ++x) {
      const auto covered = [](float low, float high, int at) {
        const auto begin = static_cast<float>(at);
        return std::clamp(std::min(high, begin + 1) - std::max(low, begin), 0.0F, 1.0F);
      };
      const float share = covered(left, right, x) * covered(top, bottom, y);
      std::uint8_t* target = pixel(image, x, y);
      for (std::size_t k = 0; k < 3; ++k) {
        target[k] =
            static_cast<std::uint8_t>(std::lround((1 - share) * target[k] + share * static_cast<float>(kInk[k])));
      }
    }
  }
}

// The font knows ASCII only.
std::string printable(const std::string& text) {
  std::string result;
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if ((code & 0xC0U) == 0x80U) continue;  // the rest of a UTF-8 letter
    result += code >= 32 && code < 127 ? c : '?';
  }
  return result;
}

int text_width(std::string text) {
  return kTextScale * stb_easy_font_width(text.data());
}

// Shortened with "..." to fit.
std::string fitted(const std::string& text, int width) {
  std::string result = printable(text);
  if (text_width(result) <= width) return result;
  while (!result.empty() && text_width(result + "...") > width) result.pop_back();
  return result + "...";
}

void draw_text(Image& image, float x, float y, std::string text) {
  struct Corner {
    float x, y, z;
    std::uint8_t colour[4];
  };
  std::vector<Corner> corners(4 * (text.size() * 32 + 16));
  const int quads = stb_easy_font_print(0, 0, text.data(), nullptr, corners.data(),
                                        static_cast<int>(corners.size() * sizeof(Corner)));
  for (std::size_t q = 0; q < static_cast<std::size_t>(quads); ++q) {
    const Corner& low = corners[4 * q];
    const Corner& high = corners[4 * q + 2];
    fill(image, x + kTextScale * low.x, y + kTextScale * low.y, x + kTextScale * high.x, y + kTextScale * high.y);
  }
}

void paste(Image& sheet, const Image& image, int left, int top) {
  for (int y = 0; y < image.height; ++y) {
    const std::size_t row = 3 * static_cast<std::size_t>(image.width);
    std::memcpy(pixel(sheet, left, top + y), &image.rgb[static_cast<std::size_t>(y) * row], row);
  }
}

void append(void* context, void* data, int size) {
  static_cast<std::string*>(context)->append(static_cast<const char*>(data), static_cast<std::size_t>(size));
}

void require_pixels(const Image& image) {
  if (image.width < 1 || image.height < 1 ||
      image.rgb.size() != 3 * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height)) {
    throw UsageError("an image of " + std::to_string(image.width) + " by " + std::to_string(image.height) +
                     " pixels has " + std::to_string(image.rgb.size()) + " bytes: must be 3 a pixel");
  }
}

}  // namespace

Image contact_sheet(const std::vector<Image>& images, const std::vector<std::string>& captions, int columns) {
  if (captions.size() != images.size()) {
    throw UsageError(std::to_string(captions.size()) + " captions for " + std::to_string(images.size()) + " images");
  }
  require(columns >= 1, "columns", columns, "at least 1");
  int cell_width = 1;
  int cell_height = 1;
  for (const Image& image : images) {
    require_pixels(image);
    cell_width = std::max(cell_width, image.width);
    cell_height = std::max(cell_height, image.height);
  }
  const int count = static_cast<int>(images.size());
  const int across = std::clamp(count, 1, columns);
  const int down = std::max(1, (count + across - 1) / across);
  Image sheet;
  sheet.width = across * cell_width + (across + 1) * kGap;
  sheet.height = down * (cell_height + kCaptionHeight) + (down + 1) * kGap;
  sheet.rgb.assign(3 * static_cast<std::size_t>(sheet.width) * static_cast<std::size_t>(sheet.height), 255);
  for (int i = 0; i < count; ++i) {
    const Image& image = images[static_cast<std::size_t>(i)];
    const int left = kGap + i % across * (cell_width + kGap);
    const int row = i / across;
    const int top = kGap + row * (cell_height + kCaptionHeight + kGap);
    paste(sheet, image, left + (cell_width - image.width) / 2, top + (cell_height - image.height) / 2);
    const std::string caption = fitted(captions[static_cast<std::size_t>(i)], cell_width);
    const int indent = (cell_width - text_width(caption)) / 2;
    draw_text(sheet, static_cast<float>(left + indent), static_cast<float>(top + cell_height + 9), caption);
  }
  return sheet;
}

std::string encode_png(const Image& image) {
  require_pixels(image);
  std::string bytes;
  if (stbi_write_png_to_func(append, &bytes, image.width, image.height, 3, image.rgb.data(), 3 * image.width) == 0) {
    throw Error("the picture cannot be encoded as PNG");
  }
  return bytes;
}

void write_png(const std::filesystem::path& file, const Image& image) {
  write_file(file, encode_png(image));
}

}  // namespace orbifit

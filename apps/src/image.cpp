#include <algorithm>
#include <cstring>
#include <sstream>
#include <string>
#include <vector>

#include "orbifit/apps/render.h"
#include "orbifit/model/errors.h"

#include "files/file.h"
#include "lettering.h"
#include "paste.h"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wold-style-cast"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#pragma GCC diagnostic ignored "-Wunused-function"
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

namespace orbifit {

namespace {

constexpr int kGap = 16;
constexpr int kLineHeight = 20;  // of a caption, pixels

// A caption's first line is its title, the others say more.
const Lettering kTitle{11, 1.7, {0.12F, 0.14F, 0.18F}};
const Lettering kDetail{10, 1.2, {0.30F, 0.33F, 0.39F}};

std::uint8_t* pixel(Image& image, int x, int y) {
  return &image.rgb[3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                         static_cast<std::size_t>(x))];
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

void draw_caption(Image& sheet, int left, int top, int width, const std::vector<std::string>& lines) {
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const Lettering& lettering = i == 0 ? kTitle : kDetail;
    const double baseline = top + kLineHeight * (static_cast<double>(i) + 0.75);
    draw_text(sheet, left, baseline, fitted_text(lines[i], width, lettering), lettering);
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

void paste(Image& sheet, const Image& image, int left, int top) {
  for (int y = 0; y < image.height; ++y) {
    const std::size_t row = 3 * static_cast<std::size_t>(image.width);
    std::memcpy(pixel(sheet, left, top + y), &image.rgb[static_cast<std::size_t>(y) * row], row);
  }
}

Image contact_sheet(const std::vector<Image>& images, const std::vector<std::string>& captions, int columns) {
  if (captions.size() != images.size()) {
    throw UsageError(std::to_string(captions.size()) + " captions for " + std::to_string(images.size()) + " images");
  }
  require(columns >= 1, "columns", columns, "at least 1");
  int cell_width = 1;
  int cell_height = 1;
  std::vector<std::vector<std::string>> lines;
  std::size_t most_lines = 1;
  for (const std::string& caption : captions) {
    lines.push_back(lines_of(caption));
    most_lines = std::max(most_lines, lines.back().size());
  }
  const int caption_height = kLineHeight * static_cast<int>(most_lines) + 6;
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
  sheet.height = down * (cell_height + caption_height) + (down + 1) * kGap;
  sheet.rgb.assign(3 * static_cast<std::size_t>(sheet.width) * static_cast<std::size_t>(sheet.height), 255);
  for (int i = 0; i < count; ++i) {
    const Image& image = images[static_cast<std::size_t>(i)];
    const int left = kGap + i % across * (cell_width + kGap);
    const int row = i / across;
    const int top = kGap + row * (cell_height + caption_height + kGap);
    paste(sheet, image, left + (cell_width - image.width) / 2, top + (cell_height - image.height) / 2);
    draw_caption(sheet, left, top + cell_height, cell_width, lines[static_cast<std::size_t>(i)]);
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

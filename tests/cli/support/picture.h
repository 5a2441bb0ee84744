#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace orbifit {

/// A PNG's pixels: red, green and blue, row by row from the top.
struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
};
Picture read_picture(const std::filesystem::path& file);

/// Share of the pixels that differ by more than `levels` of 255 in a colour; 1 where the sizes differ.
double share_that_differs(const Picture& a, const Picture& b, int levels);

}  // namespace orbifit

#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace orbifit {

struct DecodedImage {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;  ///< 3 * width * height, top row first, sRGB
};

/// \param bytes  of a PNG or JPEG file
/// \param problem  set to why there is no result
std::optional<DecodedImage> decode_image(const std::string& bytes, std::string& problem);

}  // namespace orbifit

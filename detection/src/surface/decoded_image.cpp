#include "surface/decoded_image.h"

#include <limits>
#include <memory>

#include "base/stb_image.h"

namespace orbifit {

namespace {

constexpr double kMaxPixels = 1 << 28;  // 16384 by 16384, 800 MB: larger ones are taken for broken

}  // namespace

std::optional<DecodedImage> decode_image(const std::string& bytes, std::string& problem) {
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
    problem = "is larger than 2 GiB";
    return std::nullopt;
  }
  const auto* data = reinterpret_cast<const stbi_uc*>(bytes.data());
  const int size = static_cast<int>(bytes.size());
  DecodedImage image;
  int channels = 0;
  if (stbi_info_from_memory(data, size, &image.width, &image.height, &channels) == 0) {
    problem = "is no PNG or JPEG that can be read";
    return std::nullopt;
  }
  if (static_cast<double>(image.width) * image.height > kMaxPixels) {
    problem = "has more than 268 million pixels";
    return std::nullopt;
  }
  constexpr int kChannels = 3;
  const std::unique_ptr<stbi_uc, decltype(&stbi_image_free)> pixels(
      stbi_load_from_memory(data, size, &image.width, &image.height, &channels, kChannels), &stbi_image_free);
  if (!pixels) {
    problem = std::string("is broken: ") + stbi_failure_reason();
    return std::nullopt;
  }
  const auto count = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) * kChannels;
  image.rgb.assign(pixels.get(), pixels.get() + count);
  return image;
}

}  // namespace orbifit

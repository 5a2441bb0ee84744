#include "picture.h"

#include <cstdlib>

#include "base/stb_image.h"
#include "files/file.h"

namespace orbifit {

Picture read_picture(const std::filesystem::path& file) {
  Picture picture;
  int channels = 0;
  const std::string bytes = read_file(file);
  stbi_uc* pixels =
      stbi_load_from_memory(reinterpret_cast<const stbi_uc*>(bytes.data()), static_cast<int>(bytes.size()),
                            &picture.width, &picture.height, &channels, 3);
  if (pixels == nullptr) return {};
  picture.rgb.assign(pixels, pixels + 3 * static_cast<std::ptrdiff_t>(picture.width) * picture.height);
  stbi_image_free(pixels);
  return picture;
}

double share_that_differs(const Picture& a, const Picture& b, int levels) {
  if (a.width != b.width || a.height != b.height || a.rgb.empty()) return 1;
  std::size_t differing = 0;
  for (std::size_t pixel = 0; pixel < a.rgb.size(); pixel += 3) {
    bool differs = false;
    for (std::size_t k = pixel; k < pixel + 3; ++k) differs = differs || std::abs(a.rgb[k] - b.rgb[k]) > levels;
    if (differs) ++differing;
  }
  return 3.0 * static_cast<double>(differing) / static_cast<double>(a.rgb.size());
}

}  // namespace orbifit

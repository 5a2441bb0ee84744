#include "orbifit/fitting/depth_image.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <limits>
#include <memory>
#include <string>

#include <nlohmann/json.hpp>

#include "orbifit/model/errors.h"

#include "base/stb_image.h"
#include "files/file.h"

namespace orbifit {

namespace {

constexpr char kPngSignature[] = "\x89PNG\r\n\x1a\n";

/// Grey values, row by row from the top.
struct GreyImage {
  int width = 0, height = 0;
  std::vector<std::uint16_t> values;
};

bool is_png(const std::string& content) {
  return content.compare(0, sizeof(kPngSignature) - 1, kPngSignature) == 0;
}

// \param depth  must have 16 bits of grey alone; else any image is one of how bright it is, or not transparent
GreyImage read_png(const std::filesystem::path& file, bool depth) {
  const std::string content = read_file(file);
  const auto fail = [&](const std::string& reason) { throw InputError(file.string(), "", reason); };
  if (!is_png(content)) fail("is not a PNG");
  if (content.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) fail("is larger than 2 GiB");
  const auto* bytes = reinterpret_cast<const stbi_uc*>(content.data());
  const int size = static_cast<int>(content.size());
  GreyImage image;
  int channels = 0;
  if (stbi_info_from_memory(bytes, size, &image.width, &image.height, &channels) == 0) {
    fail(std::string("is a broken PNG: ") + stbi_failure_reason());
  }
  if (depth && stbi_is_16_bit_from_memory(bytes, size) == 0) {
    fail("has 8 bits or fewer a pixel; a depth image has 16 bits of grey");
  }
  if (depth && channels != 1) {
    fail("has " + std::to_string(channels) + " channels; a depth image has 16 bits of grey alone");
  }
  const std::unique_ptr<stbi_us, void (*)(void*)> pixels(
      stbi_load_16_from_memory(bytes, size, &image.width, &image.height, &channels, 1), stbi_image_free);
  if (!pixels) fail(std::string("is a broken PNG: ") + stbi_failure_reason());
  const std::size_t count = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  image.values.assign(pixels.get(), pixels.get() + count);
  return image;
}

std::string size_of(const GreyImage& image) {
  return std::to_string(image.width) + " by " + std::to_string(image.height) + " pixels";
}

void check_camera(const std::filesystem::path& file, const GreyImage& image, const DepthCamera& camera) {
  for (const double focal : {camera.fx, camera.fy}) {
    require(focal > 0 && std::isfinite(focal), "intrinsics: a focal length", focal, "positive");
  }
  require(camera.depth_scale > 0 && std::isfinite(camera.depth_scale), "depth scale", camera.depth_scale, "positive");
  const bool inside = camera.cx >= 0 && camera.cy >= 0 && camera.cx < image.width && camera.cy < image.height;
  if (!inside) {
    throw InputError(file.string(), "intrinsics",
                     "the principal point (" + std::to_string(camera.cx) + ", " + std::to_string(camera.cy) +
                         ") is outside the image of " + size_of(image));
  }
}

}  // namespace

bool is_depth_image(const std::filesystem::path& file) {
  if (is_standard_stream(file)) return false;
  std::string beginning(sizeof(kPngSignature) - 1, '\0');
  std::ifstream stream(file, std::ios::binary);
  stream.read(beginning.data(), static_cast<std::streamsize>(beginning.size()));
  return stream && is_png(beginning);
}

PointCloud read_depth_image(const std::filesystem::path& file, const DepthCamera& camera,
                            const std::filesystem::path& mask) {
  const GreyImage image = read_png(file, true);
  check_camera(file, image, camera);
  GreyImage inside;
  if (!mask.empty()) {
    inside = read_png(mask, false);
    if (inside.width != image.width || inside.height != image.height) {
      throw InputError(mask.string(), "",
                       "has " + size_of(inside) + ", but " + file.string() + " has " + size_of(image));
    }
  }
  std::vector<double> coordinates;
  std::size_t at = 0;
  for (int v = 0; v < image.height; ++v) {
    for (int u = 0; u < image.width; ++u, ++at) {
      if (image.values[at] == 0 || (!mask.empty() && inside.values[at] == 0)) continue;
      const double depth = camera.depth_scale * image.values[at];
      const Eigen::Vector3d own((u - camera.cx) * depth / camera.fx, (v - camera.cy) * depth / camera.fy, depth);
      const Eigen::Vector3d point = camera.pose(own);
      coordinates.insert(coordinates.end(), point.data(), point.data() + 3);
    }
  }
  if (coordinates.empty()) {
    throw InputError(file.string(), "",
                     mask.empty() ? "has no depth: all pixels are 0" : "has no depth within the mask " + mask.string());
  }
  PointCloud scan;
  scan.points = Eigen::Map<const Points>(coordinates.data(), static_cast<Eigen::Index>(coordinates.size() / 3), 3);
  scan.viewpoints = camera.pose.translation.transpose();
  return scan;
}

std::vector<Motion> read_extrinsics(const std::filesystem::path& file) {
  constexpr double kRigid = 1e-4;  // of rotations written with few digits
  const auto document = nlohmann::json::parse(read_file(file), nullptr, false);
  const auto fail = [&](const std::string& key, const std::string& reason) {
    throw InputError(file.string(), key, reason);
  };
  if (document.is_discarded()) fail("", "is not JSON");
  if (!document.is_object() || !document.contains("camera_to_world") || !document.at("camera_to_world").is_array()) {
    fail("camera_to_world", "must be a list of matrices");
  }
  std::vector<Motion> result;
  for (const auto& matrix : document.at("camera_to_world")) {
    const std::string key = "camera_to_world[" + std::to_string(result.size()) + "]";
    if (!matrix.is_array() || (matrix.size() != 3 && matrix.size() != 4)) fail(key, "must have three or four rows");
    Motion motion;
    for (int r = 0; r < static_cast<int>(matrix.size()); ++r) {
      const auto& row = matrix.at(static_cast<std::size_t>(r));
      const std::string place = key + "[" + std::to_string(r) + "]";
      if (!row.is_array() || row.size() != 4) fail(place, "must be four numbers");
      for (int c = 0; c < 4; ++c) {
        const auto& entry = row.at(static_cast<std::size_t>(c));
        if (!entry.is_number()) fail(place, "must be four numbers");
        const double value = entry.get<double>();
        if (r == 3 && value != (c == 3 ? 1 : 0)) fail(place, "must be 0, 0, 0, 1");
        if (r < 3 && c < 3) motion.linear(r, c) = value;
        if (r < 3 && c == 3) motion.translation[r] = value;
      }
    }
    if (!(orthogonality_error(motion.linear) < kRigid) || !(motion.linear.determinant() > 0)) {
      fail(key, "is no rigid motion: its first three columns are not a rotation");
    }
    motion.linear = nearest_orthogonal(motion.linear);
    result.push_back(motion);
  }
  if (result.empty()) fail("camera_to_world", "is empty");
  return result;
}

}  // namespace orbifit

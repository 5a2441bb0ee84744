#include "orbifit/detection/surface_colours.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include "surface/decoded_image.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;

constexpr double kSameColour = 0.5 / 255;  // half of an 8-bit level

Vector3d pixel(const DecodedImage& image, long long x, long long y) {
  const auto wrap = [](long long value, int size) { return static_cast<std::size_t>(((value % size) + size) % size); };
  const std::size_t first = 3 * (wrap(y, image.height) * static_cast<std::size_t>(image.width) + wrap(x, image.width));
  return Vector3d(image.rgb[first], image.rgb[first + 1], image.rgb[first + 2]) / 255;
}

// Bilinear between the middles of pixels; (0, 0) is the lower left corner of the image.
Vector3d texel(const DecodedImage& image, const Eigen::Vector2d& uv) {
  constexpr double kMostRepeats = 1e9;  // of the image, beyond which pixels cannot be told apart
  if (!(uv.cwiseAbs().maxCoeff() < kMostRepeats)) return Vector3d::Ones();
  const double x = (uv.x() - std::floor(uv.x())) * image.width - 0.5;
  const double y = (1 - (uv.y() - std::floor(uv.y()))) * image.height - 0.5;
  const auto left = static_cast<long long>(std::floor(x));
  const auto top = static_cast<long long>(std::floor(y));
  const double s = x - std::floor(x);
  const double t = y - std::floor(y);
  return (1 - t) * ((1 - s) * pixel(image, left, top) + s * pixel(image, left + 1, top)) +
         t * ((1 - s) * pixel(image, left, top + 1) + s * pixel(image, left + 1, top + 1));
}

}  // namespace

struct SurfaceColours::Implementation {
  Appearance::Uvs uvs;
  Appearance::Colours colours;
  std::vector<int> material_of_face;
  std::vector<Vector3d> base;                         // of each material
  std::vector<std::optional<DecodedImage>> textures;  // of each material
  std::vector<std::string> problems;
  bool uniform = true;

  int material(int face) const {
    return material_of_face.empty() ? -1 : material_of_face[static_cast<std::size_t>(face)];
  }

  bool textured(int face) const {
    const int number = material(face);
    return number >= 0 && uvs.rows() > 0 && textures[static_cast<std::size_t>(number)];
  }
};

SurfaceColours::SurfaceColours(const Mesh& mesh, const Appearance& look)
    : implementation_(std::make_unique<Implementation>()) {
  Implementation& own = *implementation_;
  own.uvs = look.uvs;
  own.colours = look.colours;
  own.material_of_face = look.material_of_face;
  own.problems = look.warnings;
  for (const Material& material : look.materials) {
    own.base.emplace_back(material.base_colour[0], material.base_colour[1], material.base_colour[2]);
    std::optional<DecodedImage>& texture = own.textures.emplace_back();
    if (material.image.empty()) continue;
    std::string problem;
    texture = decode_image(material.image, problem);
    if (!texture) own.problems.push_back("the texture of material '" + material.name + "' " + problem);
  }
  std::optional<Vector3d> first;
  for (int f = 0; f < mesh.faces.rows() && own.uniform; ++f) {
    own.uniform = !own.textured(f);
    for (int k = 0; k < 3 && own.uniform; ++k) {
      const Vector3d colour = at(f, Vector3d::Unit(k));
      if (!first) first = colour;
      own.uniform = (colour - *first).cwiseAbs().maxCoeff() <= kSameColour;
    }
  }
}

SurfaceColours::~SurfaceColours() = default;
SurfaceColours::SurfaceColours(SurfaceColours&&) noexcept = default;
SurfaceColours& SurfaceColours::operator=(SurfaceColours&&) noexcept = default;

bool SurfaceColours::uniform() const {
  return implementation_->uniform;
}

const std::vector<std::string>& SurfaceColours::problems() const {
  return implementation_->problems;
}

Vector3d SurfaceColours::at(int face, const Vector3d& barycentric) const {
  const Implementation& own = *implementation_;
  const Eigen::Index corner = 3 * static_cast<Eigen::Index>(face);
  Vector3d colour = Vector3d::Ones();
  if (const int material = own.material(face); material >= 0) colour = own.base[static_cast<std::size_t>(material)];
  if (own.textured(face)) {
    const Eigen::Vector2d uv = (barycentric.transpose() * own.uvs.middleRows<3>(corner)).transpose();
    if (uv.allFinite()) {
      colour = colour.cwiseProduct(texel(*own.textures[static_cast<std::size_t>(own.material(face))], uv));
    }
  }
  if (own.colours.rows() > 0) {
    const Vector3d painted = (barycentric.transpose() * own.colours.middleRows<3>(corner).leftCols<3>()).transpose();
    if (painted.allFinite()) colour = colour.cwiseProduct(painted);
  }
  return colour.cwiseMax(0).cwiseMin(1);
}

}  // namespace orbifit

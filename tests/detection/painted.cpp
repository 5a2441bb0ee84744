#include "painted.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wold-style-cast"
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wsign-conversion"
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

namespace orbifit::test {

namespace {

using Eigen::Index;
using Eigen::Vector3d;

constexpr int kField = 16;  // pixels

Vector3d corner(const Mesh& mesh, Index face, int k) {
  return mesh.vertices.row(mesh.faces(face, k)).transpose();
}

// Fields side by side: pixel (i, j) of one shows the point with weights i and j of corners 1 and 2, and a little of
// what is beyond the triangle.
void paint_texture(const Mesh& mesh, const Painter& painter, Appearance& look) {
  const int columns = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(mesh.faces.rows()))));
  const int size = columns * kField;
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(3) * static_cast<std::size_t>(size) *
                                   static_cast<std::size_t>(size));
  constexpr double kInner = kField - 4;  // pixels for the triangle, two to spare at each side
  look.uvs.resize(3 * mesh.faces.rows(), 2);
  for (Index f = 0; f < mesh.faces.rows(); ++f) {
    const int left = static_cast<int>(f) % columns * kField;
    const int top = static_cast<int>(f) / columns * kField;
    for (int y = 0; y < kField; ++y) {
      for (int x = 0; x < kField; ++x) {
        const double s = (x - 1.5) / kInner;
        const double t = (y - 1.5) / kInner;
        const Vector3d colour =
            painter((1 - s - t) * corner(mesh, f, 0) + s * corner(mesh, f, 1) + t * corner(mesh, f, 2));
        for (int k = 0; k < 3; ++k) {
          const int row = (top + y) * size + left + x;
          pixels[static_cast<std::size_t>(3 * row + k)] =
              static_cast<std::uint8_t>(std::lround(255 * std::clamp(colour[k], 0.0, 1.0)));
        }
      }
    }
    for (int k = 0; k < 3; ++k) {
      const double x = left + 2 + (k == 1 ? kInner : 0);
      const double y = top + 2 + (k == 2 ? kInner : 0);
      look.uvs.row(3 * f + k) << x / size, 1 - y / size;
    }
  }
  Material material{"paint", {1, 1, 1, 1}, "paint.png", ""};
  stbi_write_png_to_func(
      [](void* context, void* data, int length) {
        static_cast<std::string*>(context)->append(static_cast<const char*>(data), static_cast<std::size_t>(length));
      },
      &material.image, size, size, 3, pixels.data(), 3 * size);
  look.materials.push_back(std::move(material));
  look.material_of_face.assign(static_cast<std::size_t>(mesh.faces.rows()), 0);
}

}  // namespace

Appearance painted(const Mesh& mesh, Paint paint, const Painter& painter) {
  Appearance look;
  if (paint == Paint::texture) {
    paint_texture(mesh, painter, look);
    return look;
  }
  look.colours = Appearance::Colours::Ones(3 * mesh.faces.rows(), 4);
  for (Index f = 0; f < mesh.faces.rows(); ++f) {
    const Vector3d middle = (corner(mesh, f, 0) + corner(mesh, f, 1) + corner(mesh, f, 2)) / 3;
    for (int k = 0; k < 3; ++k) {
      look.colours.row(3 * f + k).head<3>() = painter(paint == Paint::faces ? middle : corner(mesh, f, k)).transpose();
    }
  }
  return look;
}

}  // namespace orbifit::test

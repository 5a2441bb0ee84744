#include "sight.h"

#include <algorithm>

namespace orbifit {

namespace {

const Colour kPartColour(0.9F, 0.1F, 0.1F);
const Colour kRestColour(0.8F, 0.8F, 0.8F);

std::vector<int> other_faces(const Mesh& mesh, const std::vector<int>& faces) {
  std::vector<char> in(static_cast<std::size_t>(mesh.faces.rows()), 0);
  for (const int face : faces) in[static_cast<std::size_t>(face)] = 1;
  std::vector<int> result;
  for (int face = 0; face < static_cast<int>(in.size()); ++face) {
    if (in[static_cast<std::size_t>(face)] == 0) result.push_back(face);
  }
  return result;
}

// A small picture of the surfaces in the view of the whole mesh.
Image sketch(const Scene& scene, const Mesh& framed, ViewOptions view, const RunContext& context) {
  constexpr int kWidth = 160;
  view.height = std::max(1, kWidth * view.height / std::max(1, view.width));
  view.width = kWidth;
  view.samples = 1;
  view.ground_shadow = false;
  if (view.frame.rows() == 0) view.frame = framed.vertices;
  return render(scene, view, context);
}

bool red(const Image& image, std::size_t pixel) {
  return image.rgb[3 * pixel] > image.rgb[3 * pixel + 1] + 40;
}

bool drawn(const Image& image, std::size_t pixel) {
  return image.rgb[3 * pixel + 1] < 255;
}

}  // namespace

Sight sight_of(const Mesh& mesh, const std::vector<int>& faces, const ViewOptions& view, const RunContext& context) {
  Scene alone;
  alone.surfaces.push_back({submesh(mesh, faces), {kPartColour}, {}});
  Scene all = alone;
  all.surfaces.push_back({submesh(mesh, other_faces(mesh, faces)), {kRestColour}, {}});
  const Image image_alone = sketch(alone, mesh, view, context);
  const Image image_all = sketch(all, mesh, view, context);

  const int width = image_alone.width;
  int left = width, top = image_alone.height, right = 0, bottom = 0;
  int count = 0, seen = 0, shape = 0;
  for (std::size_t i = 0; i < image_alone.rgb.size() / 3; ++i) {
    if (drawn(image_all, i)) ++shape;
    if (red(image_all, i)) ++seen;
    if (!red(image_alone, i)) continue;
    ++count;
    const int x = static_cast<int>(i) % width;
    const int y = static_cast<int>(i) / width;
    left = std::min(left, x);
    right = std::max(right, x + 1);
    top = std::min(top, y);
    bottom = std::max(bottom, y + 1);
  }
  Sight sight;
  if (count == 0) return sight;
  sight.seen = static_cast<double>(seen) / count;
  sight.of_shape = static_cast<double>(count) / std::max(1, shape);
  const double w = width;
  const double h = image_alone.height;
  sight.box = {left / w, top / h, (right - left) / w, (bottom - top) / h};
  return sight;
}

bool is_small(const Sight& sight) {
  constexpr double kSmall = 0.2;  // of the picture's width or height
  return sight.box[2] > 0 && sight.box[3] > 0 && std::max(sight.box[2], sight.box[3]) < kSmall;
}

bool mostly_hidden(const Sight& sight) {
  constexpr double kSeen = 0.35;      // as much of a part in the open shows its shape
  constexpr double kScarcely = 0.02;  // of the shape's pixels: specks all over are found only in glass
  return sight.seen < kSeen || (sight.of_shape < kScarcely && !is_small(sight));
}

std::vector<int> faces_of(const Pattern& pattern) {
  std::vector<int> faces;
  for (const PatternInstance& instance : pattern.instances) {
    faces.insert(faces.end(), instance.faces.begin(), instance.faces.end());
  }
  return faces;
}

Scene visible_region_scene(const Mesh& mesh, const Region& region, const ViewOptions& view, const RunContext& context) {
  return region_scene(mesh, region, mostly_hidden(sight_of(mesh, region.faces, view, context)));
}

Scene visible_pattern_scene(const Mesh& mesh, const Pattern& pattern, const ViewOptions& view,
                            const RunContext& context) {
  return pattern_scene(mesh, pattern, mostly_hidden(sight_of(mesh, faces_of(pattern), view, context)));
}

}  // namespace orbifit

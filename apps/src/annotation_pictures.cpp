#include "orbifit/apps/annotation_pictures.h"

#include <algorithm>
#include <array>
#include <cstdio>

#include "lettering.h"
#include "paste.h"
#include "sight.h"

namespace orbifit {

namespace {

constexpr std::size_t kManyPictures = 8;  // beyond them fewer rays a pixel: nobody waits for smooth lines
const Colour kFrame(0.45F, 0.48F, 0.54F);

std::string percent_text(double fraction) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3g", fraction < 1e-12 ? 0 : 100 * fraction);
  return std::string(text.data()) + " %";
}

double area_share(const Eigen::VectorXd& areas, const std::vector<int>& faces) {
  double area = 0;
  for (const int face : faces) area += areas[face];
  const double total = areas.sum();
  return total > 0 ? area / total : 0;
}

std::string detail_of(double area, const Residual& residual) {
  return percent_text(area) + " of the area, residual at most " + percent_text(residual.max) + " of the diagonal";
}

std::string named(const std::string& text, const std::string& name) {
  return name.empty() ? text : text + ": " + name;
}

// Where a square around the box lies in the picture when it is `size` of its width and height.
Eigen::Vector4d window_around(const Eigen::Vector4d& box) {
  constexpr double kRoom = 1.6;   // about the part, so that one sees where it is
  constexpr double kMin = 0.025;  // of the picture: sixteen times enlarged
  const double size = std::max(kMin, kRoom * std::max(box[2], box[3]));
  return {box[0] + 0.5 * box[2] - 0.5 * size, box[1] + 0.5 * box[3] - 0.5 * size, size, size};
}

void draw_frame(Image& image, const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
  constexpr double kPen = 1.2;
  const std::array<Eigen::Vector2d, 4> corners{low, Eigen::Vector2d(high.x(), low.y()), high,
                                               Eigen::Vector2d(low.x(), high.y())};
  for (std::size_t k = 0; k < 4; ++k) draw_line(image, corners[k], corners[(k + 1) % 4], kPen, kFrame);
}

// Draws what is in the box once more, enlarged, in the corner that is farthest from it, and a line from one to the
// other.
void add_close_up(Image& image, const Scene& scene, const Eigen::Vector4d& box, ViewOptions view,
                  const RunContext& context) {
  constexpr double kShare = 0.38;  // of the picture's width and height
  const Eigen::Vector2d size(image.width, image.height);
  const Eigen::Vector4d window = window_around(box);
  view.window = window;
  view.width = static_cast<int>(kShare * image.width);
  view.height = static_cast<int>(kShare * image.height);
  view.ground_shadow = false;
  const Image close = render(scene, view, context);
  const bool at_left = window[0] + 0.5 * window[2] > 0.5;
  const bool at_top = window[1] + 0.5 * window[3] > 0.5;
  const int left = at_left ? 1 : image.width - close.width - 1;
  const int top = at_top ? 1 : image.height - close.height - 1;
  const Eigen::Vector2d low = window.head<2>().cwiseProduct(size);
  const Eigen::Vector2d high = (window.head<2>() + window.tail<2>()).cwiseProduct(size);
  const Eigen::Vector2d nearest(at_left ? left + close.width : left, at_top ? top + close.height : top);
  draw_line(image, {at_left ? low.x() : high.x(), at_top ? low.y() : high.y()}, nearest, 1.2, kFrame);
  draw_frame(image, low, high);
  paste(image, close, left, top);
  draw_frame(image, Eigen::Vector2d(left, top), Eigen::Vector2d(left + close.width, top + close.height));
}

Image picture_of(const Scene& scene, const Sight& sight, const ViewOptions& view, const RunContext& context) {
  Image image = render(scene, view, context);
  if (is_small(sight)) add_close_up(image, scene, sight.box, view, context);
  return image;
}

}  // namespace

std::vector<AnnotationPicture> annotation_pictures(const Mesh& mesh, const SymmetryAnnotation& annotation,
                                                   ViewOptions view, const RunContext& context,
                                                   const std::function<void(Scene&)>& decorate) {
  const Eigen::VectorXd areas = face_areas(mesh);
  const std::size_t total = annotation.regions.size() + annotation.patterns.size();
  if (total > kManyPictures) view.samples = std::min(view.samples, 4);
  if (view.frame.rows() == 0) view.frame = mesh.vertices;
  std::vector<AnnotationPicture> pictures;
  const auto add = [&](const auto& scene_of, const std::vector<int>& faces, const std::string& title,
                       const Residual& residual) {
    context.progress("pictures", static_cast<double>(pictures.size()) / static_cast<double>(total));
    const Sight sight = sight_of(mesh, faces, view, context);
    Scene scene = scene_of(mostly_hidden(sight));
    if (decorate) decorate(scene);
    pictures.push_back({picture_of(scene, sight, view, context), title, detail_of(area_share(areas, faces), residual)});
  };
  for (const Region& region : annotation.regions) {
    add([&](bool see_through) { return region_scene(mesh, region, see_through); }, region.faces,
        named("region " + std::to_string(region.id) + "  " + region.group.symbol(), region.name), region.residual);
  }
  for (const Pattern& pattern : annotation.patterns) {
    add([&](bool see_through) { return pattern_scene(mesh, pattern, see_through); }, faces_of(pattern),
        named("pattern " + std::to_string(pattern.id) + "  " + std::to_string(pattern.instances.size()) + " × " +
                  to_string(pattern.kind),
              pattern.name),
        pattern.residual);
  }
  if (pictures.empty()) {
    Scene plain;
    plain.surfaces.emplace_back().mesh = mesh;
    if (decorate) decorate(plain);
    pictures.push_back({render(plain, view, context), "no symmetry found", ""});
  }
  return pictures;
}

Image contact_sheet(const std::vector<AnnotationPicture>& pictures, int columns) {
  std::vector<Image> images;
  std::vector<std::string> captions;
  for (const AnnotationPicture& picture : pictures) {
    images.push_back(picture.image);
    captions.push_back(picture.detail.empty() ? picture.title : picture.title + "\n" + picture.detail);
  }
  return contact_sheet(images, captions, columns);
}

}  // namespace orbifit

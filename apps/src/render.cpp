#include "orbifit/apps/render.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "orbifit/model/errors.h"

#include "camera.h"
#include "light.h"
#include "ray_scene.h"

namespace orbifit {

namespace {

using Vector = Eigen::Vector3f;

constexpr float kShadowStrength = 0.62F;  // of the ground at its darkest
constexpr int kMaxGlassLayers = 12;

void validate(const ViewOptions& view) {
  require(view.width >= 1 && view.width <= 16384, "width", view.width, "from 1 to 16384");
  require(view.height >= 1 && view.height <= 16384, "height", view.height, "from 1 to 16384");
  require(view.field_of_view >= 1 && view.field_of_view <= 150, "field_of_view", view.field_of_view,
          "from 1 to 150 degrees");
  const int side = static_cast<int>(std::lround(std::sqrt(std::max(view.samples, 0))));
  require(side >= 1 && side <= 16 && side * side == view.samples, "samples", view.samples,
          "a square number from 1 to 256");
  require(view.window.allFinite() && view.window[2] > 0 && view.window[3] > 0, "size of window", view.window[2],
          "positive");
  require(view.up.allFinite() && view.up.stableNorm() > 0, "length of up", view.up.stableNorm(), "positive");
}

Points all_points(const Scene& scene) {
  std::vector<const Points*> parts;
  for (const SurfaceLayer& layer : scene.surfaces) parts.push_back(&layer.mesh.vertices);
  for (const PointLayer& layer : scene.points) parts.push_back(&layer.points);
  for (const SegmentLayer& layer : scene.segments) {
    parts.push_back(&layer.from);
    parts.push_back(&layer.to);
  }
  Eigen::Index count = 0;
  for (const Points* part : parts) count += part->rows();
  Points points(count, 3);
  count = 0;
  for (const Points* part : parts) {
    points.middleRows(count, part->rows()) = *part;
    count += part->rows();
  }
  return points;
}

Points box_corners(const Points& points) {
  const Eigen::RowVector3d low = points.colwise().minCoeff();
  const Eigen::RowVector3d high = points.colwise().maxCoeff();
  Points corners(8, 3);
  for (int i = 0; i < 8; ++i) {
    for (int k = 0; k < 3; ++k) corners(i, k) = (i >> k & 1) == 0 ? low[k] : high[k];
  }
  return corners;
}

// The picture's part of the work that every pixel shares.
class Painter {
 public:
  Painter(const RayScene& scene, const Camera& camera, const Ground& ground, const ViewOptions& view,
          const RunContext& context)
      : scene_(scene),
        camera_(camera),
        ground_(ground),
        view_(view),
        lamps_(lamps(camera)),
        background_(linear_colour(view.background)),
        buffer_(light_buffer(scene, camera, ground, view.width, view.height, context)) {
    if (scene.has_glass()) look_through_glass(context);
  }

  Vector pixel(int x, int y) const {
    const int side = static_cast<int>(std::lround(std::sqrt(view_.samples)));
    const bool plain = !scene_.draws_edges() && even(x, y);
    const Ray through_middle = ray_at(x, y, 0.5F, 0.5F);
    const Base middle = plain ? base(x, y, through_middle) : Base{};
    const bool marked = scene_.has_marks() && scene_.near_mark(through_middle);
    if (plain && !marked && even_glass(x, y))
      return encoded(scene_.has_glass() ? glass_at(x, y).over(middle.colour) : middle.colour);
    const bool layered = marked || scene_.has_glass();
    Vector sum = Vector::Zero();
    for (int j = 0; j < side; ++j) {
      for (int i = 0; i < side; ++i) {
        const Ray ray = ray_at(x, y, (static_cast<float>(i) + 0.5F) / static_cast<float>(side),
                               (static_cast<float>(j) + 0.5F) / static_cast<float>(side));
        const Base behind = plain ? middle : base(x, y, ray);
        // Averaged as the eye sees it: edges against white stay smooth.
        sum += encoded(layered ? with_layers(ray, behind) : behind.colour);
      }
    }
    return sum / static_cast<float>(side * side);
  }

 private:
  // Whether the pixel and its neighbours see one smooth surface of one colour, or nothing but ground.
  bool even(int x, int y) const {
    const PixelSurface& middle = buffer_.at(x, y);
    const int reach = middle.kind == PixelSurface::Kind::surface ? 1 : 2;
    for (int v = std::max(0, y - reach); v <= std::min(view_.height - 1, y + reach); ++v) {
      for (int u = std::max(0, x - reach); u <= std::min(view_.width - 1, x + reach); ++u) {
        const PixelSurface& other = buffer_.at(u, v);
        if (other.kind != middle.kind) return false;
        if (middle.kind != PixelSurface::Kind::surface) continue;
        if (other.normal.dot(middle.normal) < 0.98F) return false;
        if ((other.colour - middle.colour).cwiseAbs().maxCoeff() > 0.03F) return false;
        const float step = std::abs((other.position - middle.position).dot(middle.normal));
        if (step > 3 * scene_.pixel_width * middle.distance) return false;
      }
    }
    return true;
  }

  // All the glass before the middle of a pixel: what it adds, and the share of what is behind that passes.
  struct Glass {
    Vector colour = Vector::Zero();
    float passes = 1;

    Vector over(const Vector& behind) const { return colour + passes * behind; }
  };

  const Glass& glass_at(int x, int y) const {
    return glass_[static_cast<std::size_t>(y) * static_cast<std::size_t>(view_.width) + static_cast<std::size_t>(x)];
  }

  void look_through_glass(const RunContext& context) {
    const auto width = static_cast<std::size_t>(view_.width);
    glass_.resize(width * static_cast<std::size_t>(view_.height));
    parallel_for(context, glass_.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t place = begin; place < end; ++place) {
        const int x = static_cast<int>(place % width);
        const int y = static_cast<int>(place / width);
        const PixelSurface& behind = buffer_.at(x, y);
        const bool surface = behind.kind == PixelSurface::Kind::surface;
        glass_[place] =
            glass(ray_at(x, y, 0.5F, 0.5F), surface ? behind.distance : std::numeric_limits<float>::infinity());
      }
    });
  }

  // Whether the pixel and its neighbours look through the same glass.
  bool even_glass(int x, int y) const {
    if (!scene_.has_glass()) return true;
    const Glass& middle = glass_at(x, y);
    for (int v = std::max(0, y - 1); v <= std::min(view_.height - 1, y + 1); ++v) {
      for (int u = std::max(0, x - 1); u <= std::min(view_.width - 1, x + 1); ++u) {
        const Glass& other = glass_at(u, v);
        if (std::abs(other.passes - middle.passes) > 0.02F) return false;
        if ((other.colour - middle.colour).cwiseAbs().maxCoeff() > 0.02F) return false;
      }
    }
    return true;
  }

  // What a ray sees of opaque surfaces, the ground and the background.
  struct Base {
    Vector colour = Vector::Zero();
    float distance = std::numeric_limits<float>::infinity();  // of the opaque surface
  };

  Ray ray_at(int x, int y, float within_x, float within_y) const {
    return camera_.ray((static_cast<float>(x) + within_x) / static_cast<float>(view_.width),
                       (static_cast<float>(y) + within_y) / static_cast<float>(view_.height));
  }

  Base base(int x, int y, const Ray& ray) const {
    const float infinity = std::numeric_limits<float>::infinity();
    if (const auto hit = scene_.surface(ray, infinity)) {
      const Light light = buffer_.light(x, y, hit->position, hit->normal, PixelSurface::Kind::surface);
      return {shade(*hit, ray, light), hit->distance};
    }
    const float distance = ground_distance(ground_, ray);
    if (!std::isfinite(distance)) return {background_, infinity};
    return {ground_colour(x, y, ray.origin + distance * ray.direction), infinity};
  }

  // Marks and glass in front of it. The ground hides neither: an axis must not end at the shadow's plane.
  Vector with_layers(const Ray& ray, const Base& behind) const {
    Vector colour = behind.colour;
    float end = behind.distance;
    if (const auto mark = scene_.mark(ray, end)) {
      end = mark->distance;
      colour = shade(*mark, ray);
    }
    return scene_.has_glass() ? glass(ray, end).over(colour) : colour;
  }

  Vector ground_colour(int x, int y, const Vector& position) const {
    const Light light = buffer_.light(x, y, position, ground_.up, PixelSurface::Kind::ground);
    // Fades out towards the horizon and the picture's rim, so that the shadow has no border.
    const float open = 0.6F * light.sky + 0.4F * light.key;
    const auto to_rim = static_cast<float>(std::min({x, y, view_.width - 1 - x, view_.height - 1 - y}));
    const float fade = std::clamp(1.6F - position.norm(), 0.0F, 1.0F) *
                       std::clamp(to_rim / (0.06F * static_cast<float>(view_.height)), 0.0F, 1.0F);
    return background_ * (1 - kShadowStrength * fade * (1 - open));
  }

  Vector shade(const SurfaceHit& hit, const Ray& ray, const Light& light) const {
    const float facing_key = std::max(0.0F, hit.normal.dot(lamps_.key));
    const float facing_fill = std::max(0.0F, 0.5F + 0.5F * hit.normal.dot(lamps_.fill));
    const float upwards = 0.5F + 0.5F * hit.normal.dot(camera_.up);
    const float diffuse = 0.70F * facing_key * light.key + light.sky * (0.14F * facing_fill + 0.27F + 0.17F * upwards);
    const Vector half_way = (lamps_.key - ray.direction).normalized();
    const float glint = 0.07F * light.key * std::pow(std::max(0.0F, hit.normal.dot(half_way)), 30.0F);
    return rolled_off(hit.colour * diffuse + Vector::Constant(glint));
  }

  // Highlights approach white without a border.
  static Vector rolled_off(const Vector& light) {
    return light.unaryExpr([](float v) { return v > 0.7F ? 0.7F + 0.3F * std::tanh((v - 0.7F) / 0.3F) : v; });
  }

  Vector shade(const MarkHit& mark, const Ray& ray) const {
    const float facing_key = std::max(0.0F, mark.normal.dot(lamps_.key));
    const float facing_eye = std::max(0.0F, -mark.normal.dot(ray.direction));
    return mark.colour * (0.45F + 0.35F * facing_key + 0.25F * facing_eye);
  }

  Glass glass(const Ray& ray, float end) const {
    Glass result;
    scene_.glass(ray, end, kMaxGlassLayers, [&](const SurfaceHit& hit) {
      // Seen edge-on glass is denser.
      const float facing = std::abs(hit.normal.dot(ray.direction));
      const float opacity = 1 - std::pow(1 - hit.opacity, 1 / std::max(facing, 0.35F));
      result.colour += result.passes * opacity * shade(hit, ray, {1, 1});
      result.passes *= 1 - opacity;
    });
    return result;
  }

  // Linear light to sRGB.
  static Vector encoded(const Vector& light) {
    return light.unaryExpr([](float value) {
      const float v = std::clamp(value, 0.0F, 1.0F);
      return v <= 0.0031308F ? 12.92F * v : 1.055F * std::pow(v, 1 / 2.4F) - 0.055F;
    });
  }

  const RayScene& scene_;
  const Camera& camera_;
  const Ground& ground_;
  const ViewOptions& view_;
  Lamps lamps_;
  Vector background_;
  LightBuffer buffer_;
  std::vector<Glass> glass_;  // one a pixel, if there is any
};

}  // namespace

Image render(const Scene& scene, const ViewOptions& view, const RunContext& context) {
  validate(view);
  const Points drawn = all_points(scene);
  Points framed = view.frame.rows() > 0 ? view.frame : drawn;
  if (framed.rows() == 0) framed = Points::Zero(1, 3);
  if (framed.rows() == 2) framed = box_corners(framed);
  Eigen::Matrix<double, 2, 3> box;
  box << framed.colwise().minCoeff(), framed.colwise().maxCoeff();
  const double size = (box.row(1) - box.row(0)).norm();
  const double scale = size > 0 ? 1 / size : 1;
  const Eigen::RowVector3d centre = 0.5 * box.row(0) + 0.5 * box.row(1);
  const auto local = [&](const Points& points) -> Points { return scale * (points.rowwise() - centre); };

  const Camera camera = frame_points(local(framed), view);
  const float pixel_width = 2 * camera.half_height * camera.window[3] / static_cast<float>(view.height);
  double farthest = 0;
  const Points placed = local(drawn);
  for (const auto& point : placed.rowwise()) {
    farthest = std::max(farthest, (point.transpose() - camera.eye.cast<double>()).norm());
  }
  RayScene rays(scene, box, pixel_width * static_cast<float>(farthest));
  rays.pixel_width = pixel_width;
  Ground ground;
  ground.up = horizon(view.up).up.cast<float>();
  if (view.ground_shadow && !scene.surfaces.empty()) {
    double lowest = std::numeric_limits<double>::infinity();
    for (const SurfaceLayer& layer : scene.surfaces) {
      if (layer.opacity < 1 || layer.mesh.vertices.rows() == 0) continue;
      lowest = std::min(lowest, (local(layer.mesh.vertices) * ground.up.cast<double>()).minCoeff());
    }
    ground.shown = std::isfinite(lowest);
    ground.height = static_cast<float>(lowest) - 1e-4F;
  }

  const Painter painter(rays, camera, ground, view, context);
  Image image;
  image.width = view.width;
  image.height = view.height;
  image.rgb.resize(3 * static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height));
  parallel_for(context, static_cast<std::size_t>(view.height), [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y) {
      std::uint8_t* target = &image.rgb[3 * y * static_cast<std::size_t>(view.width)];
      for (int x = 0; x < view.width; ++x) {
        const Vector colour = painter.pixel(x, static_cast<int>(y));
        for (int k = 0; k < 3; ++k) {
          *target++ = static_cast<std::uint8_t>(std::lround(255 * std::clamp(colour[k], 0.0F, 1.0F)));
        }
      }
    }
  });
  return image;
}

}  // namespace orbifit

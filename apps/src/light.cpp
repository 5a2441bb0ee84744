#include "light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Geometry>

namespace orbifit {

namespace {

constexpr int kTile = 4;
constexpr int kRays = 8;            // to the sky, and as many to the key lamp, a pixel
constexpr float kSkyReach = 0.45F;  // diagonals; what is farther does not darken
constexpr float kKeyReach = 3.0F;
constexpr float kKeyRadius = 0.16F;  // of the lamp, radians: soft shadows
constexpr float kLift = 2e-4F;       // above the surface, diagonals

// `bits` bits in reverse order, as a fraction of 1.
float radical_inverse(int index, int bits) {
  int reversed = 0;
  for (int bit = 0; bit < bits; ++bit) reversed = (reversed << 1) | (index >> bit & 1);
  return static_cast<float>(reversed) / static_cast<float>(1 << bits);
}

// A Hammersley set of a pixel's rays, shifted from cell to cell of the tile so that together they fill its gaps.
Eigen::Vector2f unit_square_point(int cell, int ray) {
  const float shift_x = (static_cast<float>(cell) + 0.5F) / (kTile * kTile);
  const float shift_y = radical_inverse(cell, 4);
  return {(static_cast<float>(ray) + shift_x) / kRays, radical_inverse(ray, 3) + shift_y / kRays};
}

// The order in which the cells of a tile are numbered: neighbours get far directions (Bayer's matrix).
constexpr int kBayer[kTile * kTile] = {0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5};

struct Basis {
  Eigen::Vector3f first, second, normal;
};

// Duff et al. 2017.
Basis basis_about(const Eigen::Vector3f& normal) {
  const float sign = std::copysign(1.0F, normal.z());
  const float a = -1 / (sign + normal.z());
  const float b = normal.x() * normal.y() * a;
  return {{1 + sign * normal.x() * normal.x() * a, sign * b, -sign * normal.x()},
          {b, sign + normal.y() * normal.y() * a, -normal.y()},
          normal};
}

using Directions = std::array<Eigen::Vector3f, kRays>;

Directions sky_directions(const Eigen::Vector3f& normal, int cell) {
  const Basis basis = basis_about(normal);
  Directions directions;
  for (int i = 0; i < kRays; ++i) {
    const Eigen::Vector2f u = unit_square_point(cell, i);
    const float radius = std::sqrt(u.x());
    const float angle = 2 * std::numbers::pi_v<float> * u.y();
    directions[static_cast<std::size_t>(i)] = radius * std::cos(angle) * basis.first +
                                              radius * std::sin(angle) * basis.second +
                                              std::sqrt(1 - u.x()) * basis.normal;
  }
  return directions;
}

Directions key_directions(const Eigen::Vector3f& key, int cell) {
  const Basis basis = basis_about(key);
  Directions directions;
  for (int i = 0; i < kRays; ++i) {
    const Eigen::Vector2f u = unit_square_point(cell, i);
    const float radius = kKeyRadius * std::sqrt(u.x());
    const float angle = 2 * std::numbers::pi_v<float> * u.y();
    directions[static_cast<std::size_t>(i)] =
        (key + radius * (std::cos(angle) * basis.first + std::sin(angle) * basis.second)).normalized();
  }
  return directions;
}

float open_share(unsigned blocked) {
  int count = 0;
  for (int i = 0; i < kRays; ++i) count += static_cast<int>(blocked >> static_cast<unsigned>(i) & 1U);
  return 1 - static_cast<float>(count) / kRays;
}

// Weight with which the light at one place serves for another of the same kind: none across edges and steps.
float likeness(const PixelSurface& known, const Eigen::Vector3f& position, const Eigen::Vector3f& normal,
               PixelSurface::Kind kind, float pixel_size) {
  if (known.kind != kind || known.kind == PixelSurface::Kind::nothing) return 0;
  const float bend = known.normal.dot(normal);
  if (bend < 0.8F) return 0;
  const float step = std::abs((known.position - position).dot(normal));
  if (step > 6 * pixel_size) return 0;
  return bend * bend;
}

void trace_row(LightBuffer& buffer, const RayScene& scene, const Camera& camera, const Ground& ground,
               const Directions* key_rays, int y) {
  const float infinity = std::numeric_limits<float>::infinity();
  const Eigen::Vector3f key = lamps(camera).key;
  for (int x = 0; x < buffer.width; ++x) {
    const Ray ray = camera.ray((static_cast<float>(x) + 0.5F) / static_cast<float>(buffer.width),
                               (static_cast<float>(y) + 0.5F) / static_cast<float>(buffer.height));
    const auto place =
        static_cast<std::size_t>(y) * static_cast<std::size_t>(buffer.width) + static_cast<std::size_t>(x);
    PixelSurface& pixel = buffer.surfaces[place];
    Eigen::Vector3f origin;
    if (const auto hit = scene.surface(ray, infinity)) {
      pixel = {PixelSurface::Kind::surface, hit->position, hit->normal, hit->colour, hit->distance};
      origin = hit->lifted + kLift * hit->geometric_normal;
    } else {
      const float distance = ground_distance(ground, ray);
      if (!std::isfinite(distance)) continue;
      const Eigen::Vector3f position = ray.origin + distance * ray.direction;
      pixel = {PixelSurface::Kind::ground, position, ground.up, Eigen::Vector3f::Ones(), distance};
      origin = position;
    }
    const int cell = kBayer[y % kTile * kTile + x % kTile];
    Light& light = buffer.lights[place];
    light.sky = open_share(scene.occluded(origin, sky_directions(pixel.normal, cell).data(), kRays, kSkyReach));
    light.key = 0;
    if (pixel.normal.dot(key) > -kKeyRadius) {
      light.key = open_share(scene.occluded(origin, key_rays[cell].data(), kRays, kKeyReach));
    }
  }
}

// The mean over a window as wide as a tile and centred: its outermost pixels count half.
void smooth_row(const LightBuffer& raw, std::vector<Light>& smooth, float pixel_width, int y) {
  constexpr int reach = kTile / 2;
  for (int x = 0; x < raw.width; ++x) {
    const PixelSurface& pixel = raw.at(x, y);
    if (pixel.kind == PixelSurface::Kind::nothing) continue;
    const float pixel_size = pixel_width * pixel.distance;
    float sky = 0;
    float key = 0;
    float total = 0;
    for (int j = -reach; j <= reach; ++j) {
      for (int i = -reach; i <= reach; ++i) {
        const int u = x + i;
        const int v = y + j;
        if (u < 0 || v < 0 || u >= raw.width || v >= raw.height) continue;
        float weight = likeness(raw.at(u, v), pixel.position, pixel.normal, pixel.kind, pixel_size);
        if (std::abs(i) == reach) weight *= 0.5F;
        if (std::abs(j) == reach) weight *= 0.5F;
        const Light& light =
            raw.lights[static_cast<std::size_t>(v) * static_cast<std::size_t>(raw.width) + static_cast<std::size_t>(u)];
        sky += weight * light.sky;
        key += weight * light.key;
        total += weight;
      }
    }
    const auto place = static_cast<std::size_t>(y) * static_cast<std::size_t>(raw.width) + static_cast<std::size_t>(x);
    smooth[place] = {sky / total, key / total};
  }
}

}  // namespace

Lamps lamps(const Camera& camera) {
  return {(-0.55F * camera.right + 0.95F * camera.up + 0.75F * camera.toward).normalized(),
          (0.85F * camera.right + 0.15F * camera.up + 0.55F * camera.toward).normalized()};
}

float ground_distance(const Ground& ground, const Ray& ray) {
  const float infinity = std::numeric_limits<float>::infinity();
  const float descent = -ray.direction.dot(ground.up);
  if (!ground.shown || descent < 1e-3F) return infinity;
  const float distance = (ray.origin.dot(ground.up) - ground.height) / descent;
  return distance > 0 ? distance : infinity;
}

const PixelSurface& LightBuffer::at(int x, int y) const {
  return surfaces[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
}

Light LightBuffer::light(int x, int y, const Eigen::Vector3f& position, const Eigen::Vector3f& normal,
                         PixelSurface::Kind kind) const {
  float sky = 0;
  float key = 0;
  float total = 0;
  for (int v = std::max(0, y - 1); v <= std::min(height - 1, y + 1); ++v) {
    for (int u = std::max(0, x - 1); u <= std::min(width - 1, x + 1); ++u) {
      const PixelSurface& pixel = at(u, v);
      if (pixel.kind != kind) continue;
      // Any pixel of the same kind serves where none is alike.
      const float apart = (pixel.position - position).squaredNorm() + 1e-10F;
      const float bend = std::max(0.0F, pixel.normal.dot(normal));
      const float weight = (1e-3F + bend * bend * bend * bend) / apart;
      const Light& known =
          lights[static_cast<std::size_t>(v) * static_cast<std::size_t>(width) + static_cast<std::size_t>(u)];
      sky += weight * known.sky;
      key += weight * known.key;
      total += weight;
    }
  }
  if (!(total > 0)) return {0.8F, 0.8F};
  return {sky / total, key / total};
}

LightBuffer light_buffer(const RayScene& scene, const Camera& camera, const Ground& ground, int width, int height,
                         const RunContext& context) {
  LightBuffer buffer;
  buffer.width = width;
  buffer.height = height;
  const std::size_t count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  buffer.surfaces.resize(count);
  buffer.lights.resize(count);
  std::array<Directions, static_cast<std::size_t>(kTile * kTile)> key_rays;
  for (std::size_t cell = 0; cell < key_rays.size(); ++cell) {
    key_rays[cell] = key_directions(lamps(camera).key, static_cast<int>(cell));
  }
  const auto over_rows = [&](const auto& body) {
    parallel_for(context, static_cast<std::size_t>(height), [&](std::size_t begin, std::size_t end) {
      for (std::size_t y = begin; y < end; ++y) body(static_cast<int>(y));
    });
  };
  over_rows([&](int y) { trace_row(buffer, scene, camera, ground, key_rays.data(), y); });
  std::vector<Light> smooth(count);
  over_rows([&](int y) { smooth_row(buffer, smooth, scene.pixel_width, y); });
  buffer.lights = std::move(smooth);
  return buffer;
}

}  // namespace orbifit

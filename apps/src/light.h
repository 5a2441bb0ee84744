#pragma once

#include <vector>

#include <Eigen/Core>

#include "orbifit/model/run_context.h"

#include "camera.h"
#include "ray_scene.h"

namespace orbifit {

/// The plane below the shape that catches its shadow; scene units.
struct Ground {
  bool shown = false;
  Eigen::Vector3f up;
  float height = 0;
};

/// What the middle of a pixel sees.
struct PixelSurface {
  enum class Kind { nothing, surface, ground };
  Kind kind = Kind::nothing;
  Eigen::Vector3f position, normal, colour;
  float distance = 0;
};

/// How much light reaches a place: 1 when nothing is in the way.
struct Light {
  float sky = 1;  ///< share of the hemisphere that is open, cosine-weighted
  float key = 1;  ///< share of the key light that is visible
};

/// One sun-like lamp and one weak one, at fixed places beside the camera so that every view is lit alike.
struct Lamps {
  Eigen::Vector3f key, fill;  ///< unit, towards the lamp
};
Lamps lamps(const Camera& camera);

/// Visible surfaces and the light on them, one a pixel. A pixel spends few shadow rays, each pixel of a 4 by 4 tile in
/// other directions; averaging neighbours of the same surface then gives what all the tile's rays together would
/// (interleaved sampling, Keller and Heidrich 2001). No random numbers: the same bytes with any number of threads.
struct LightBuffer {
  int width = 0, height = 0;
  std::vector<PixelSurface> surfaces;
  std::vector<Light> lights;

  const PixelSurface& at(int x, int y) const;

  /// Light at a place seen in pixel (x, y): from the pixels about it that see the same surface.
  Light light(int x, int y, const Eigen::Vector3f& position, const Eigen::Vector3f& normal,
              PixelSurface::Kind kind) const;
};

LightBuffer light_buffer(const RayScene& scene, const Camera& camera, const Ground& ground, int width, int height,
                         const RunContext& context);

/// Where the ray meets the ground in front of the camera; infinity when it does not.
float ground_distance(const Ground& ground, const Ray& ray);

}  // namespace orbifit

#pragma once

#include <Eigen/Core>

#include "orbifit/apps/render.h"

#include "ray_scene.h"

namespace orbifit {

/// A pinhole that looks along -toward; in the units of a RayScene.
struct Camera {
  Eigen::Vector3f eye, right, up, toward;
  float half_width = 0, half_height = 0;  ///< of the picture at distance 1
  Eigen::Vector4f window{0, 0, 1, 1};     ///< ViewOptions::window

  /// The ray through a place of the window; (0, 0) is the top left corner, (1, 1) the bottom right.
  Ray ray(float x, float y) const;
};

/// The camera from which all points (#P by 3, scene units) just fit the picture, with a small margin.
Camera frame_points(const Points& points, const ViewOptions& view);

/// Directions of the world in which azimuth and elevation are measured: `up` and two horizontal ones, right-handed.
struct Horizon {
  Eigen::Vector3d first, second, up;
};
Horizon horizon(const Eigen::Vector3d& up);

}  // namespace orbifit

#include "camera.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Geometry>

namespace orbifit {

namespace {

constexpr double kMargin = 1.06;
constexpr double kRadians = std::numbers::pi / 180;

// Seen straight from above or below the picture's up is the horizon's.
constexpr double kSteepest = 89.9;

}  // namespace

Ray Camera::ray(float x, float y) const {
  const float u = window[0] + x * window[2];
  const float v = window[1] + y * window[3];
  const Eigen::Vector3f direction = (2 * u - 1) * half_width * right + (1 - 2 * v) * half_height * up - toward;
  return {eye, direction.normalized()};
}

Horizon horizon(const Eigen::Vector3d& up) {
  Horizon result;
  result.up = up.stableNorm() > 0 ? up.stableNormalized() : Eigen::Vector3d::UnitZ();
  // The coordinate axis after the one nearest to up: x for z up, z for y up.
  int dominant = 0;
  result.up.cwiseAbs().maxCoeff(&dominant);
  const Eigen::Vector3d next = Eigen::Vector3d::Unit((dominant + 1) % 3);
  result.first = (next - next.dot(result.up) * result.up).normalized();
  result.second = result.up.cross(result.first);
  return result;
}

void look_from(const Eigen::Vector3d& direction, ViewOptions& view) {
  if (!(direction.norm() > 0)) return;
  const Horizon world = horizon(view.up);
  view.azimuth = std::atan2(world.second.dot(direction), world.first.dot(direction)) / kRadians;
  view.elevation = std::asin(std::clamp(world.up.dot(direction) / direction.norm(), -1.0, 1.0)) / kRadians;
}

Camera frame_points(const Points& points, const ViewOptions& view) {
  const Horizon world = horizon(view.up);
  const double azimuth = view.azimuth * kRadians;
  const double elevation = std::clamp(view.elevation, -kSteepest, kSteepest) * kRadians;
  const Eigen::Vector3d toward =
      std::cos(elevation) * (std::cos(azimuth) * world.first + std::sin(azimuth) * world.second) +
      std::sin(elevation) * world.up;
  const Eigen::Vector3d right = world.up.cross(toward).normalized();
  const Eigen::Vector3d up = toward.cross(right);

  Camera camera;
  const double half_height = std::tan(0.5 * std::clamp(view.field_of_view, 1.0, 150.0) * kRadians);
  const double half_width = half_height * view.width / view.height;
  camera.half_height = static_cast<float>(half_height);
  camera.half_width = static_cast<float>(half_width);
  camera.window = view.window.cast<float>();

  // From distance d a point at (x, y, z) in camera axes fits when |x - x_eye| <= (d - z) half_width, the same with y.
  const Eigen::ArrayXd x = points * right;
  const Eigen::ArrayXd y = points * up;
  const Eigen::ArrayXd z = points * toward;
  const auto fit = [&](const Eigen::ArrayXd& across, double half) -> Eigen::Vector2d {
    const double high = (across + half * z).maxCoeff();
    const double low = (-across + half * z).maxCoeff();
    return {0.5 * (high - low), 0.5 * (high + low) / half};  // the eye's place and its distance
  };
  const Eigen::Vector2d horizontal = fit(x, half_width / kMargin);
  const Eigen::Vector2d vertical = fit(y, half_height / kMargin);
  const double distance = std::max({horizontal[1], vertical[1], z.maxCoeff() + 1e-3});

  camera.eye = (horizontal[0] * right + vertical[0] * up + distance * toward).cast<float>();
  camera.right = right.cast<float>();
  camera.up = up.cast<float>();
  camera.toward = toward.cast<float>();
  return camera;
}

}  // namespace orbifit

#include "geometry/exposure.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace orbifit {

Exposure::Exposure(const Mesh& mesh) : surface_(mesh), size_(diagonal(mesh.vertices)) {
  constexpr int kDirections = 64;
  for (int i = 0; i < kDirections; ++i) {  // a Fibonacci spiral
    const double z = (2 * i + 1.0) / kDirections - 1;
    const double angle = 2 * std::numbers::pi * i / std::numbers::phi;
    const double radius = std::sqrt(1 - z * z);
    directions_.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
  }
}

bool Exposure::operator()(const Eigen::Vector3d& point) const {
  return std::ranges::any_of(directions_, [&](const Eigen::Vector3d& direction) {
    return !surface_.occluded(point, direction, 1e-4 * size_, 10 * size_);
  });
}

}  // namespace orbifit

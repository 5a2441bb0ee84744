#pragma once

#include <algorithm>
#include <cmath>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace orbifit {

/// Calls add(point) on points of the triangle (a, b, c) no farther apart than `spacing`, its corners among them: in
/// rows along the longest edge.
template <typename Add>
void cover_triangle(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c, double spacing,
                    const Add& add) {
  const Eigen::Vector3d corners[3] = {a, b, c};
  const double lengths[3] = {(b - a).norm(), (c - b).norm(), (a - c).norm()};
  const auto first = std::max_element(lengths, lengths + 3) - lengths;
  const Eigen::Vector3d start = corners[first];
  const Eigen::Vector3d end = corners[(first + 1) % 3];
  const Eigen::Vector3d apex = corners[(first + 2) % 3];
  const double height = (apex - start).cross(end - start).norm() / std::max(lengths[first], 1e-300);
  const int rows = static_cast<int>(std::ceil(height / spacing));
  for (int r = 0; r <= rows; ++r) {
    const double up = rows == 0 ? 0 : static_cast<double>(r) / rows;
    const Eigen::Vector3d left = start + up * (apex - start);
    const Eigen::Vector3d right = end + up * (apex - end);
    const int columns = static_cast<int>(std::ceil((right - left).norm() / spacing));
    for (int k = 0; k <= columns; ++k) {
      add(columns == 0 ? left : Eigen::Vector3d(left + static_cast<double>(k) / columns * (right - left)));
    }
  }
}

}  // namespace orbifit

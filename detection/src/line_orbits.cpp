#include "line_orbits.h"

#include <algorithm>
#include <cstddef>

#include <Eigen/Geometry>

namespace orbifit {

std::vector<char> few_of_each_orbit(const std::vector<Line>& lines, const std::vector<Motion>& motions,
                                    double tolerance) {
  constexpr int kFew = 3;
  constexpr double kAngle = 0.03;  // radians
  std::vector<char> few(lines.size(), 1);
  if (motions.size() < static_cast<std::size_t>(kFew)) return few;
  struct Orbit {
    Line first;
    int count = 0;
  };
  std::vector<Orbit> orbits;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const auto is_image = [&](const Orbit& orbit) {
      return std::ranges::any_of(motions, [&](const Motion& motion) {
        const Eigen::Vector3d direction = motion.linear * lines[i].direction;
        return direction.cross(orbit.first.direction).norm() < kAngle &&
               (motion(lines[i].point) - orbit.first.point).cross(orbit.first.direction).norm() < tolerance;
      });
    };
    const auto orbit = std::ranges::find_if(orbits, is_image);
    if (orbit == orbits.end()) {
      orbits.push_back({lines[i], 1});
    } else {
      few[i] = ++orbit->count <= kFew ? 1 : 0;
    }
  }
  return few;
}

}  // namespace orbifit

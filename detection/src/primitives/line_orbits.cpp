#include "primitives/line_orbits.h"

#include <algorithm>
#include <cstddef>

#include <Eigen/Geometry>

#include "surface/thresholds.h"

namespace orbifit {

namespace {

constexpr int kLooksOfOrbit = 3;

}  // namespace

LineOrbits::LineOrbits(const std::vector<Line>& lines, const std::vector<Motion>& motions, double tolerance) {
  std::vector<Line> firsts;
  for (const Line& line : lines) {
    const auto is_image = [&](const Line& first) {
      return std::ranges::any_of(motions, [&](const Motion& motion) {
        const Eigen::Vector3d direction = motion.linear * line.direction;
        return direction.cross(first.direction).norm() < kSameDirection &&
               (motion(line.point) - first.point).cross(first.direction).norm() < tolerance;
      });
    };
    const auto orbit = motions.size() < static_cast<std::size_t>(kLooksOfOrbit)
                           ? firsts.end()
                           : std::ranges::find_if(firsts, is_image);
    orbit_of_line_.push_back(static_cast<std::size_t>(orbit - firsts.begin()));
    if (orbit == firsts.end()) firsts.push_back(line);
  }
  looks_.assign(firsts.size(), 0);
  found_.assign(firsts.size(), 0);
}

bool LineOrbits::worth_a_look(std::size_t line) {
  const std::size_t orbit = orbit_of_line_[line];
  return ++looks_[orbit] <= kLooksOfOrbit || found_[orbit] != 0;
}

std::vector<char> few_of_each_orbit(const std::vector<Line>& lines, const std::vector<Motion>& motions,
                                    double tolerance) {
  LineOrbits orbits(lines, motions, tolerance);
  std::vector<char> few;
  for (std::size_t i = 0; i < lines.size(); ++i) few.push_back(orbits.worth_a_look(i) ? 1 : 0);
  return few;
}

}  // namespace orbifit

#pragma once

#include <algorithm>
#include <vector>

#include "orbifit/model/motion.h"
#include "orbifit/model/point_group.h"

#include "group/refinement.h"
#include "surface/surface_patch.h"

namespace orbifit::test {

// A group placed in the input's frame, as it stands in the prepared mesh's.
inline GroupPlacement normalised(const PreparedMesh& prepared, GroupPlacement placement) {
  const Similarity to = inverse(prepared.input_of_normalised);
  placement.centre = to(placement.centre);
  placement.frame = to.linear * placement.frame;
  return placement;
}

inline std::vector<Motion> motions_of(const GroupPlacement& placement) {
  std::vector<Motion> motions;
  for (const Eigen::Matrix3d& linear : elements(placement.group, placement.frame)) {
    motions.push_back(Motion::about(linear, placement.centre));
  }
  return motions;
}

// Largest distance of an element of `of` from the nearest of `to`, on the points of the unit ball.
inline double farthest(const std::vector<Motion>& of, const std::vector<Motion>& to) {
  double result = 0;
  for (const Motion& each : of) {
    double nearest = 1e300;
    for (const Motion& other : to) {
      nearest = std::min(nearest, motion_distance(each, other, Eigen::Vector3d::Zero(), 1));
    }
    result = std::max(result, nearest);
  }
  return result;
}

inline double apart(const std::vector<Motion>& a, const std::vector<Motion>& b) {
  return std::max(farthest(a, b), farthest(b, a));
}

inline std::vector<Motion> conjugated(const Motion& by, std::vector<Motion> motions) {
  for (Motion& motion : motions) motion = conjugate(by, motion);
  return motions;
}

}  // namespace orbifit::test

#pragma once

#include <algorithm>

#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"

namespace orbifit {

/// The largest distance between where two poses bring the points, of the points' diagonal as the second pose brings
/// it. \param points  #P by 3
inline double poses_apart(const Points& points, const Similarity& pose, const Similarity& truth) {
  double worst = 0;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const Eigen::Vector3d point = points.row(i);
    worst = std::max(worst, (pose(point) - truth(point)).norm());
  }
  return worst / (truth.scale * diagonal(points));
}

}  // namespace orbifit

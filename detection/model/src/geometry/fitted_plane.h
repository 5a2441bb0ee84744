#pragma once

#include <vector>

#include "orbifit/model/mesh.h"

namespace orbifit {

/// The plane of least squared distances to some points, and how they lie about it.
struct FittedPlane {
  Eigen::Vector3d normal;  ///< unit, its sign arbitrary; any direction across a line where the points are collinear
  Eigen::Vector3d point;   ///< the points' mean
  /// Standard deviations of the points from their mean, ascending, in the points' unit: across the plane, then along
  /// its two principal directions.
  Eigen::Vector3d deviations;
};

/// \param points #P by 3 \param chosen numbers of the points to use \pre at least one is chosen
FittedPlane fitted_plane(const Points& points, const std::vector<int>& chosen);

}  // namespace orbifit

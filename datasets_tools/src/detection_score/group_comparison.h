#pragma once

#include <vector>

#include "orbifit/model/annotation.h"

namespace orbifit::scoring {

/// A region's group with what comparisons need, worked out once.
struct PlacedGroup {
  explicit PlacedGroup(const Region& given);

  const Region& region;
  std::vector<AxisAngle> parts;  ///< of the elements, in their order
  Eigen::Matrix3d onto_fixed;    ///< projection onto the directions of the fixed set through the centre

  /// The point of the fixed set nearest to p.
  Eigen::Vector3d fixed_point(const Eigen::Vector3d& p) const;
};

struct GroupComparison {
  bool same = false;        ///< the same symbol
  bool contains = false;    ///< the predicted group holds the true one
  bool half = false;        ///< it is a subgroup of index 2
  double axis_error = 180;  ///< degrees: the worst angle from an axis to the nearest one of its kind
  double offset = 0;        ///< between the fixed sets, mesh units, near the true region's centroid
};

GroupComparison compare_groups(const PlacedGroup& truth, const PlacedGroup& predicted, const Eigen::Vector3d& centroid);

/// Whether the orthogonal matrix is, within `degrees`, in the continuous group about the axis.
bool in_continuous_group(const Eigen::Matrix3d& linear, PointGroup::Family family, const Eigen::Vector3d& axis,
                         double degrees);

/// Angle between two lines in degrees, 0 to 90.
double angle_between_axes(const Eigen::Vector3d& a, const Eigen::Vector3d& b);

}  // namespace orbifit::scoring

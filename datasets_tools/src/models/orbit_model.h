#pragma once

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/model/point_group.h"

namespace orbifit {

struct OrbitOptions {
  int subdivisions = 2;                              ///< of each copy's 4 sides, 0 to 5: 4^(n+1) triangles a copy
  double radius = 1;                                 ///< of the sphere on which the copies sit, > 0
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< a point that the group leaves fixed
  GroupFrame frame = GroupFrame::Identity();         ///< in which the group is written

  void validate() const;  ///< \throw UsageError
};

/// A small chiral body copied by every element of a finite group: the whole mesh has that group and no larger one.
/// Copies stand apart from one another. One region, the whole; C1 gives one copy and no region.
/// \throw UsageError for a continuous group
GeneratedModel generate_orbit(const PointGroup& group, const OrbitOptions& options = {});

}  // namespace orbifit

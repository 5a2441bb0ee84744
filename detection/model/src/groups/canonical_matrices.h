#pragma once

#include <vector>

#include <Eigen/Core>

#include "orbifit/model/point_group.h"

namespace orbifit {

/// The elements of a finite group in its own frame, the identity first; the identity alone for any other.
std::vector<Eigen::Matrix3d> canonical_elements(const PointGroup& group);

/// Generators in the group's own frame; of a continuous group, a turn by one radian stands for the rotations about an
/// axis.
std::vector<Eigen::Matrix3d> canonical_generators(const PointGroup& group);

}  // namespace orbifit

#pragma once

#include <cstddef>

#include "orbifit/model/point_group.h"

namespace orbifit {

/// How often motions halve a surface: log2 of the places to which they take a point. Times the area, that is what a
/// region or a pattern saves: the more is saved, the less need be told of the surface.
double halvings(std::size_t places);

/// Of a group. Of a continuous one ConsistencyPolicy::circle places on a circle count as different.
double halvings(const PointGroup& group);

}  // namespace orbifit

#pragma once

#include <vector>

#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

#include "geometry/point_index.h"

namespace orbifit {

/// Numbers of the `count` points of the index that are nearest to a place, nearest first.
std::vector<int> nearest_points(const PointIndex& index, const Eigen::Vector3d& place, int count);

/// Unit normals at points[kept], of the plane through the nearest `neighbours` points (the point itself among them),
/// sign arbitrary. \param points #P by 3 \param index of those \return #kept by 3
Points plane_normals(const Points& points, const PointIndex& index, const std::vector<int>& kept, int neighbours,
                     const RunContext& context);

}  // namespace orbifit

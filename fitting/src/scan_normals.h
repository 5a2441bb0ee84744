#pragma once

#include <vector>

#include "orbifit/model/mesh.h"

namespace orbifit {

/// Unit normals at points[kept]: of the plane through the nearest `neighbours` points (PCL), sign arbitrary.
/// Its own file because PCL's headers are slow to compile.
Points plane_normals(const Points& points, const std::vector<int>& kept, int neighbours);

}  // namespace orbifit

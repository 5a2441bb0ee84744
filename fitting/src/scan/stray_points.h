#pragma once

#include <vector>

#include "orbifit/model/mesh.h"

#include "geometry/point_index.h"

namespace orbifit {

/// Of some points of a scan those that are not strays. A stray has its nearest points several times as far away as most
/// have, and is not one of a surface that is merely scanned more sparsely: its neighbours lie about no plane, or it is
/// far off theirs. Where the scan sees little of a shape, strays would be all that pulls at the rest of it.
/// \param points  of the scan #P by 3 \param kept  numbers of those to judge, ascending
/// \param index  of them all \param typical  some numbers from which to tell what most have
std::vector<int> without_strays(const Points& points, const std::vector<int>& kept, const PointIndex& index,
                                const std::vector<int>& typical);

}  // namespace orbifit

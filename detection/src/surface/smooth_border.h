#pragma once

#include <array>
#include <functional>
#include <vector>

#include "surface/face_sides.h"
#include "surface/surface_patch.h"

namespace orbifit {

/// The share of a set's border, by length, along which the surface goes on smoothly: within four tolerances of it no
/// more than an eighth of the surface faces elsewhere by over 20 degrees. Parts end at creases and where others are
/// joined to them; what ends within planes and gentle curves is what some motion happens to keep.
/// Looks at no more than 300 edges. \param faces ascending \param sides of all faces, see face_sides()
/// \param tolerance a length
/// \param excused whether the middle of an edge, where the surface goes on smoothly, is a place for a border all the
///                same; null: none is
/// \return 0 where nothing is beyond the border
double smooth_border_share(const PreparedMesh& prepared, const std::vector<std::array<FaceSide, 3>>& sides,
                           const std::vector<int>& faces, double tolerance,
                           const std::function<bool(const Eigen::Vector3d& middle)>& excused = {});

}  // namespace orbifit

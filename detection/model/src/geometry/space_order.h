#pragma once

#include <vector>

#include "orbifit/model/mesh.h"

namespace orbifit {

/// Numbers of the points along a curve that fills their box (Morton 1966): neighbours in space come to lie next to one
/// another, mostly. Points at the same place stay in order. O(n log n)
std::vector<int> space_order(const Points& points);

}  // namespace orbifit

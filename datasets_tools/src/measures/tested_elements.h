#pragma once

#include <vector>

#include "orbifit/model/annotation.h"
#include "orbifit/model/motion.h"

#include "measures/region_surface.h"

namespace orbifit {

/// The motions on which a region is measured, told from its centre: all but the identity of a finite group; for a
/// continuous one its discrete elements and those rotations and mirrors that the tessellation itself has (a cylinder of
/// n facets is turned by multiples of 2 pi / n), up to 12.
std::vector<Motion> tested_elements(const Region& region, const RegionSurface& surface);

}  // namespace orbifit

#pragma once

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"

namespace orbifit {

/// What ring_average() found.
struct Rings {
  int rings = 0;       ///< or spheres
  int places = 0;      ///< on rings of at least 3
  double scatter = 0;  ///< root mean square movement, mesh units
};

/// Moves the places of a turned part onto circles about its axis: those whose distance from the axis and height agree
/// to within `link` of another's form a ring and take its mean distance and height. About a point (K, Kh): spheres.
/// Places that stand alone stay.
/// \param link   mesh units, >= 0
/// \param places #P by 3, in and out; unchanged where no rings are found
Rings ring_average(const Region& region, double link, Points& places);

}  // namespace orbifit

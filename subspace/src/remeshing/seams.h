#pragma once

#include <vector>

#include "remeshing/clipped_surface.h"
#include "remeshing/finite_group.h"
#include "remeshing/fundamental_domain.h"

namespace orbifit {

/// `point` is what `element` makes of `other`.
struct WallPairing {
  int point, other, element;
};

struct Seams {
  std::vector<WallPairing> pairings;  ///< of every vertex on a wall, with itself where the wall's element fixes it
  int unmatched = 0;                  ///< curves on walls that have no counterpart: cracks
};

/// Makes the curves in which a surface meets a wall and its partner have the same vertices: what one of them lacks is
/// put into the triangles beside it.
/// \param snap   vertices of both nearer than this share of the edges at them become one
/// \param reach  mesh units: how far counterparts may be from one another
Seams sew(ClippedSurface& surface, const FiniteGroup& group, const FundamentalDomain& domain, double snap,
          double reach);

}  // namespace orbifit

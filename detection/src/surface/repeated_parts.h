#pragma once

#include "geometry/topology.h"
#include "surface/surface_patch.h"

namespace orbifit {

/// Cuts one surface into what may repeat on it: without the largest pieces, the host, what is left falls apart into
/// copies, as a wall's windows, a ladder's rungs or a stair's steps do. So many of the largest pieces are taken away
/// that most of the area is in parts of which there are at least three of about equal area; then single pieces more, or
/// less, as long as that helps.
/// \param prepared with pieces of surface between creases for components
/// \return each piece of the host by itself, and the parts; one component for each, in the order of their lowest faces
/// Costs O(E) for the E edges, and as many unions for each piece tried.
Components repeated_parts(const PreparedMesh& prepared);

}  // namespace orbifit

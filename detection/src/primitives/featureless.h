#pragma once

#include "orbifit/model/run_context.h"

#include "group/refinement.h"
#include "surface/surface_ends.h"
#include "surface/surface_patch.h"

namespace orbifit {

/// Whether the patch slides over the whole surface as freely as its group maps it to itself: a piece of a larger plane,
/// cylinder or sphere, whose border alone gives it a group. Slippable twists (Gelfand and Guibas 2004) are tried at
/// several amounts, those left out that belong to a continuous group claimed. What slides past an end of the surface
/// that the group does not keep tells nothing, as long as half of the patch tells.
/// \param whole index of the whole mesh \param ends its ends \param tolerance of the whole, a length
bool featureless(const SurfacePatch& patch, const GroupPlacement& placement, const SurfaceIndex& whole,
                 const SurfaceEnds& ends, double tolerance, const RunContext& context);

}  // namespace orbifit

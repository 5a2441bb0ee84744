#pragma once

#include "orbifit/model/run_context.h"

#include "group/refinement.h"
#include "surface/surface_patch.h"

namespace orbifit {

/// Whether the patch slides over the whole surface as freely as its group maps it to itself: a piece of a larger plane,
/// cylinder or sphere, whose border alone gives it a group. Slippable twists (Gelfand and Guibas 2004) are tried at
/// several amounts, those left out that belong to a continuous group claimed.
/// \param whole index of the whole mesh \param tolerance of the whole, a length
bool featureless(const SurfacePatch& patch, const GroupPlacement& placement, const SurfaceIndex& whole,
                 double tolerance, const RunContext& context);

}  // namespace orbifit

#pragma once

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

namespace orbifit {

/// Makes detected regions fit together: first they share axes exactly where they nearly do (share_axes, within the
/// annotation's tolerance), then the result is the annotation without the regions whose groups do not close together
/// with those of earlier ones: where two regions overlap and their axes miss each other by a little, going to and fro
/// between them carries a point ever farther, and no displacement but the trivial one keeps both. Detected regions may
/// do so, since each is right within a tolerance. Regions are taken in their order, so an annotation should list the
/// more important ones first; each one left out is named in a message. What is left shares axes anew without the first
/// that did not fit, as long as that keeps more regions, up to six times. Orbits of some points of each region are
/// followed, O(regions * orbit) each time.
SymmetryAnnotation closable(const Mesh& mesh, const SymmetryAnnotation& detected, const RunContext& context);

}  // namespace orbifit

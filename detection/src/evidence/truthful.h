#pragma once

#include "orbifit/detection/explanation.h"
#include "orbifit/model/annotation.h"
#include "orbifit/model/run_context.h"

#include "surface/surface_patch.h"

namespace orbifit {

/// Takes out of every region and pattern of an annotation the faces that a motion of its group, or from one instance to
/// the others, takes farther than the annotation's tolerance from the rest, and then those that had their images
/// there, until all that is left is within the tolerance (region_residual()). What keeps too little of its area goes.
/// For each region, O(P M) look-ups in a grid for P points on its faces and M motions. \return whether anything changed
bool make_truthful(const PreparedMesh& prepared, SymmetryAnnotation& annotation, Explanation* explanation,
                   const RunContext& context);

/// Measures every region and pattern: region_residual(), pattern_residual().
void measure_residuals(const PreparedMesh& prepared, SymmetryAnnotation& annotation, const RunContext& context);

}  // namespace orbifit

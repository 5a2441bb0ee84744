#pragma once

#include "orbifit/detection/explanation.h"
#include "orbifit/model/annotation.h"
#include "orbifit/model/run_context.h"

#include "consistency/region_shapes.h"
#include "surface/surface_patch.h"

namespace orbifit {

/// Lets regions that end within smooth surface keep clear of parts that they only touch, or cut. Where the border of
/// the one lies is chance, to some faces; the other ends where the shape does. If motions of one of them have no image
/// of the other, vertices that both have could go by neither group: the region gives up its faces there, with all their
/// images, as long as enough of it is left (ConsistencyPolicy). What its motions take to other parts stays as it is.
/// \param surface  of the mesh of the annotation, which has the faces of `prepared`
/// Costs O(R (R + F)) for R regions and F faces, and some hundred nearest-point queries for each pair that touches.
void yield_to_parts(const PreparedMesh& prepared, const ShapeSurface& surface, SymmetryAnnotation& annotation,
                    Explanation* explanation, const RunContext& context);

}  // namespace orbifit

#pragma once

#include "orbifit/model/annotation.h"
#include "orbifit/model/consistent_annotation.h"
#include "orbifit/model/run_context.h"

#include "consistency/region_shapes.h"

namespace orbifit {

/// The public function, for annotations of one mesh and tolerance one after another: what was answered is known.
/// \param surface  of the mesh, for the annotations' tolerance (ConsistencySearch::surface_of())
ConsistentAnnotation consistent_annotation(const ShapeSurface& surface, const SymmetryAnnotation& annotation,
                                           const RunContext& context);

}  // namespace orbifit

#pragma once

#include <vector>

#include "orbifit/detection/explanation.h"
#include "orbifit/model/annotation.h"
#include "orbifit/model/run_context.h"

#include "consistency/region_shapes.h"
#include "surface/surface_patch.h"

namespace orbifit {

/// Where a region's border lies.
enum class BorderPlace : signed char {
  kOfPart,       ///< where the shape goes on in another way
  kBeforeEnds,   ///< within smooth surface, but motions take it to where the surface ends (SurfaceEnds)
  kWithinSmooth  ///< within smooth surface: more of it than EvidencePolicy lets a part have
};

/// By the regions' places in the list. Costs O(F log F) for F faces and some hundred looks for each region.
/// \param tolerance  a fraction of the diagonal
std::vector<BorderPlace> border_places(const PreparedMesh& prepared, const std::vector<Region>& regions,
                                       double tolerance, const RunContext& context);

/// Lets regions that end within smooth surface keep clear of parts that they only touch, or cut. Where the border of
/// the one lies is chance, to some faces; the other ends where the shape does. If motions of one of them have no image
/// of the other, vertices that both have could go by neither group: the region gives up its faces there, with all their
/// images, as long as enough of it is left (ConsistencyPolicy); where it ends before what the surface lacks, only if
/// those parts save more than it loses. What its motions take to other parts stays as it is.
/// \param surface  of the annotation's mesh \param borders  by the regions' ids: border_places()
/// Costs O(R^2) for R regions, and some hundred nearest-point queries for each pair that touches.
void yield_to_parts(const ShapeSurface& surface, const std::vector<BorderPlace>& borders,
                    SymmetryAnnotation& annotation, Explanation* explanation, const RunContext& context);

}  // namespace orbifit

#pragma once

#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

#include "geometry/surface_index.h"
#include "remeshing/dual_contour.h"

namespace orbifit {

/// Moves the vertices of quadrangles to where the planes of a surface nearby meet, some passes long, and cuts them into
/// triangles along the diagonals that follow the surface better (Ohtake and Belyaev 2002, "Dynamic mesh optimization").
/// Vertices stay within a unit of where they were; triangles do not turn over.
/// \param target   what to fit to, consistently oriented, in units of a cell
/// \param normals  of the target's faces
Mesh fitted_triangles(const DualSurface& surface, const SurfaceIndex& target, const Points& normals, int passes,
                      RunContext& context);

}  // namespace orbifit

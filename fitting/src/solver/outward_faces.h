#pragma once

#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

#include "symmetry/moving_surface.h"

namespace orbifit {

/// Whether the faces look outwards, so that a scan's oriented normals must agree with theirs in sign: a ray into the
/// body meets its far side from within.
/// \param surface  of the mesh
bool faces_outwards(const Mesh& mesh, const MovingSurface& surface, const RunContext& context);

}  // namespace orbifit

#pragma once

#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"
#include "orbifit/subspace/deformer.h"
#include "orbifit/subspace/subspace.h"

#include "deformation/corotation.h"

namespace orbifit {

/// The Laplace energy of a subspace's samples, which a Deformer lowers: equation (3) with the Laplacian asked for.
Corotation deformation_energy(const Subspace& subspace, const Mesh& mesh, LaplacianKind kind,
                              const RunContext& context);

}  // namespace orbifit

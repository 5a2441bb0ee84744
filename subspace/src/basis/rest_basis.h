#pragma once

#include "orbifit/subspace/subspace.h"

namespace orbifit {

/// Adds to the basis at rest what follows from the rest of the subspace: transports, bindings and atoms.
void complete_rest_basis(Subspace& subspace);

}  // namespace orbifit

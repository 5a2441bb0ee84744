#pragma once

#include "basis/subspace_parts.h"

namespace orbifit {

/// Adds to the basis at rest what follows from the rest of the subspace: transports, bindings and atoms.
void complete_rest_basis(SubspaceParts& subspace);

}  // namespace orbifit

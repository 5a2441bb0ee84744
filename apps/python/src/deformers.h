#pragma once

#include "orbifit/subspace/deformer.h"

#include "subspaces.h"

namespace orbifit::python {

/// What a solve left, with the subspace that its coordinates are of.
struct KeptDeformation {
  SubspacePointer of;
  Deformation deformation;
};

/// Handles of what stands for them: objects with `vertices` and, where they move, `motion`. \throw InputError
std::vector<Handle> handles_from(const py::handle& handles, const Mesh& mesh);

}  // namespace orbifit::python

#pragma once

#include "orbifit/model/mesh.h"

namespace orbifit::benchmarks {

/// A mesh of about so many faces by OpenMesh's Decimater: the cheapest collapses by quadrics (Garland and Heckbert
/// 1997) first, none that turns a face by more than a right angle. \throw InputError for a mesh that OpenMesh cannot
/// hold
Mesh decimated(const Mesh& mesh, int faces);

}  // namespace orbifit::benchmarks

#pragma once

#include "orbifit/datasets_tools/generate.h"

namespace orbifit::benchmarks {

/// The model with every triangle cut into n^2 by lines parallel to its edges: about n^2 times the vertices, the same
/// surface, the same symmetries.
/// \param n >= 1
GeneratedModel refined(const GeneratedModel& model, int n);

}  // namespace orbifit::benchmarks

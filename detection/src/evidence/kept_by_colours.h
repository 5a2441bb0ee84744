#pragma once

#include <vector>

#include "orbifit/detection/surface_colours.h"
#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

#include "evidence/colour_samples.h"

namespace orbifit {

struct KeptByColours {
  SymmetryAnnotation annotation;        ///< regions have subgroups, patterns fewer instances, or are gone
  std::vector<BrokenByColours> broken;  ///< regions first, in the order of the annotation
};

/// Reduces each region's group to the largest subgroup that keeps the colours, and each pattern to the most instances
/// that have the same ones; a pattern that loses some is one without a lattice.
/// \pre `samples` are of `mesh`
KeptByColours kept_by_colours(const Mesh& mesh, const SymmetryAnnotation& annotation, const ColourSamples& samples,
                              const RunContext& context);

}  // namespace orbifit

#pragma once

#include <cstddef>
#include <vector>

#include "orbifit/detection/explanation.h"
#include "orbifit/model/annotation.h"
#include "orbifit/model/run_context.h"

#include "surface/surface_patch.h"

namespace orbifit {

/// Orders regions and patterns by what they save, given those before them, of the quotient's area (the surface of which
/// all else is images): the next is always the one that saves most. `importance` is that saving as a share of the area
/// that was left. Images of one another (families_of()) are listed one after the other, with the saving of all. What
/// saves next to nothing that those before have not is left out, unless all is asked for. Numbers and parents are set.
/// \return the families of regions listed, by their places in the list
std::vector<std::vector<std::size_t>> list_by_importance(const PreparedMesh& prepared, SymmetryAnnotation& annotation,
                                                         bool all, Explanation* explanation, const RunContext& context);

}  // namespace orbifit

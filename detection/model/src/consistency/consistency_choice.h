#pragma once

#include <optional>

#include "orbifit/model/annotation.h"
#include "orbifit/model/consistent_annotation.h"
#include "orbifit/model/run_context.h"

#include "consistency/region_shapes.h"

namespace orbifit {

/// Of claims that contradict one another, those to keep: the ones that together save the most area. A search that takes
/// all of them, largest first, tells what it refuses and what is in the way; wherever what was refused saves more than
/// that, a search without the latter is tried, and taken if what it keeps saves more in all.
/// The whole shape's regions are never given up. Cost: a search for each trial, as far as `ConsistencyPolicy::work`
/// goes.
/// \param surface  of the mesh, for the annotation's tolerance (ConsistencySearch::surface_of())
/// \return nothing where all of them agree as they are
std::optional<ConsistentAnnotation> chosen_annotation(const ShapeSurface& surface, const SymmetryAnnotation& annotation,
                                                      const RunContext& context);

}  // namespace orbifit

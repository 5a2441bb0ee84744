#pragma once

#include <cstddef>
#include <vector>

#include "orbifit/detection/explanation.h"
#include "orbifit/model/annotation.h"
#include "orbifit/model/run_context.h"

#include "surface/surface_patch.h"

namespace orbifit {

/// A copy of the annotation without what follows from the rest. Families of images (families_of()) are taken one after
/// the other: those on whole parts before those that end within one, each by how often its motions halve its area,
/// times that area. One follows if it saves next to nothing of the quotient's area (the surface of which all else is
/// images) that those before it have not, unless it is a main part (EvidencePolicy).
/// \param annotation  in the frame of the mesh that was given, as list_by_importance()
SymmetryAnnotation without_what_follows(const PreparedMesh& prepared, const SymmetryAnnotation& annotation,
                                        const RunContext& context);

/// Orders regions and patterns by what they save, given those before them, of the quotient's area: the next is always
/// the one that saves most. `importance` is that saving as a share of the area that was left. Images of one another are
/// listed one after the other, with the saving of all. What follows from the rest (without_what_follows()) is left out,
/// or last with importance 0 where all is asked for; with it what motions of others take it to (disagreements()), so
/// that what is listed of a consistent annotation is consistent. Numbers and parents are set.
/// \return the families of regions listed, by their places in the list
std::vector<std::vector<std::size_t>> list_by_importance(const PreparedMesh& prepared, SymmetryAnnotation& annotation,
                                                         bool all, Explanation* explanation, const RunContext& context);

}  // namespace orbifit

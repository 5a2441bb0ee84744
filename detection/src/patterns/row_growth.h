#pragma once

#include <optional>

#include "orbifit/detection/explanation.h"
#include "orbifit/model/annotation.h"
#include "orbifit/model/run_context.h"

#include "surface/surface_patch.h"

namespace orbifit {

/// The part that the step of a row, an arc or a screw repeats. Pieces of one surface that repeat are often faces of a
/// part only, such as the edges of shelves, or what is between parts, such as the wall behind them. The part is what
/// hangs together, is carried along from its first place to all others, and has nothing at the place before; surface
/// along which the step slides, as the wall that shelves are fixed to, belongs to none.
/// \param pattern of one generator, in the frame of the mesh as it was given; of others nothing grows
/// \param tolerance fraction of the diagonal
/// \return the pattern of the part that covers most; nothing where that is no tenth more than the pattern given does,
/// or an instance is no copy of the first Costs O(F I) look-ups for F faces and I instances.
std::optional<Pattern> grown_row(const PreparedMesh& prepared, const Pattern& pattern, double tolerance,
                                 const RunContext& context);

}  // namespace orbifit

#pragma once

#include "orbifit/datasets_tools/detection_score.h"

#include "base/random.h"
#include "detection_score/scored_surface.h"

namespace orbifit::scoring {

/// Whether random motions of the part's own continuous symmetry fit the whole mesh as well as the group does:
/// slippable twists (Gelfand and Guibas 2004), those left out that map a continuous group to itself.
/// \param part the region's faces \param whole all faces, at 0.5 % of the diagonal
bool featureless(const ScoredSurface& part, double part_diagonal, const Region& region, const ScoredSurface& whole,
                 Random& random, const RunContext& context);

/// Whether instance 0 also fits the mesh at fractions of the pattern's step.
/// \param part instance 0
bool featureless(const ScoredSurface& part, const Pattern& pattern, const ScoredSurface& whole, Random& random,
                 const RunContext& context);

}  // namespace orbifit::scoring

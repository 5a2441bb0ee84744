#pragma once

#include <vector>

#include "orbifit/model/annotation.h"

#include "base/random.h"
#include "detection_score/scored_surface.h"

namespace orbifit::scoring {

/// The motions under which a region is tried, without the identity: at most 60 of a finite group, generators among
/// them; random turns of a continuous one, with each of its cosets.
std::vector<Motion> tried_elements(const Region& region, Random& random);

/// The area fraction that stays on the region under all of them; 0 for no area.
double region_validity(const ScoredSurface& surface, const Region& region, int samples, Random& random,
                       const RunContext& context);

}  // namespace orbifit::scoring

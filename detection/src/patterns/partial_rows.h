#pragma once

#include <vector>

#include "orbifit/detection/explanation.h"
#include "orbifit/model/run_context.h"

#include "support/found_region.h"

namespace orbifit {

/// Drops regions that are some of a row, a grid or an arc. An element h of a region's group carries any smaller region
/// R with a group G onto h(R), with the group h G h^-1. Where R and h(R) share half of R without being the same, what
/// they share has both groups: of parallel mirrors it has their product too, a translation, and repeats. Any few in a
/// row have a group like that of the row, about their middle; the row itself is a pattern.
/// Regions stay that share nothing with their images, such as both of a pair; that have another group than the row,
/// such as some links of a chain about one of them; and those whose products turn into themselves after a few times.
/// \param tolerance of the detector, a fraction of the diagonal
void drop_some_of_rows(const PreparedMesh& prepared, double tolerance, const RunContext& context,
                       std::vector<FoundRegion>& regions, Explanation* explanation = nullptr);

}  // namespace orbifit

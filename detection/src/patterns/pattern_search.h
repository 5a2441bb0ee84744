#pragma once

#include <vector>

#include "orbifit/model/annotation.h"
#include "orbifit/model/run_context.h"

#include "search/part_regions.h"
#include "support/found_region.h"

namespace orbifit {

/// The arrangements of congruent parts that no region's group relates. What belongs together is one pattern: parts that
/// touch, and that the same motions carry from instance to instance, such as a window's frame and its pane.
/// \param prepared with the parts for components \param parts what find_part_regions() says of them
/// \param regions all regions found \param options those of find_part_regions(): of pieces, copies without order and
/// rings say nothing
/// \return in the frame of the mesh as it was given, ids from 0
/// Costs O(C I) look-ups for C components and I instances a pattern.
std::vector<Pattern> find_patterns(const PreparedMesh& prepared, const PartRegions& parts,
                                   const std::vector<FoundRegion>& regions, const PartRegionOptions& options,
                                   const RunContext& context);

}  // namespace orbifit

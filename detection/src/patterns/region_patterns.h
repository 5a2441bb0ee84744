#pragma once

#include <vector>

#include "orbifit/model/annotation.h"

#include "search/part_regions.h"

namespace orbifit {

/// Patterns of regions that are copies of one another and that no region's group relates: bolts on one surface are no
/// components, but each was found to have a group. Of regions that overlap the one of the larger group is looked at;
/// what a known pattern says already is left out, and so are pairs.
/// \param known patterns found before \param options of the parts, see PartRegionOptions
/// \return in the frame of the mesh as it was given, ids following those of `known`
/// Costs O(F) and a survey of the regions of at most a tenth of the surface.
std::vector<Pattern> find_region_patterns(const PreparedMesh& prepared, const std::vector<FoundRegion>& regions,
                                          const std::vector<Pattern>& known, const PartRegionOptions& options,
                                          const RunContext& context);

}  // namespace orbifit

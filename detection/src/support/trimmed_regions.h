#pragma once

#include <functional>
#include <vector>

#include "orbifit/model/run_context.h"

#include "support/border_vote.h"
#include "support/found_region.h"
#include "surface/surface_patch.h"

namespace orbifit {

/// Makes the largest residual of each region that is beyond the tolerance come within it. First its border is drawn
/// where most of its images have it (voted_border()), where that brings it nearer. Then the faces go that an element
/// takes farther than the tolerance from those that are left. A region keeps them where that would take more than a
/// tenth of its area: it ends within a surface whose faces are too large for the group's images of its border. Round
/// regions with facets that are large for the tolerance stay as they are. What was not measured and stays is measured.
/// \param tolerance of the detector, a fraction of the diagonal \param late  whether no time is left: regions that were
/// not looked at then stay as they are; empty: there is
/// Costs O((B + D) M log F) for B faces at a region's border, D that go, M elements and F faces; nothing but samples
/// for a region that is within the tolerance.
void trim_regions(const PreparedMesh& prepared, double tolerance, BorderMoves moves, const RunContext& context,
                  std::vector<FoundRegion>& regions, Explanation* explanation = nullptr,
                  const std::function<bool()>& late = {});

}  // namespace orbifit

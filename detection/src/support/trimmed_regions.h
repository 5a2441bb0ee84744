#pragma once

#include <functional>
#include <vector>

#include "orbifit/model/run_context.h"

#include "support/found_region.h"
#include "surface/surface_patch.h"

namespace orbifit {

/// Takes from each region of a finite group the faces that an element takes farther than the tolerance from those that
/// are left, so that its largest residual is within the tolerance. A region stays as it is where that would take more
/// than a tenth of its area: it ends within a surface whose faces are too large for the group's images of its border.
/// What was not measured and stays is measured.
/// \param tolerance of the detector, a fraction of the diagonal \param late  whether no time is left: regions that were
/// not looked at then stay as they are; empty: there is
/// Costs O((B + D) M log F) for B faces at a region's border, D that go, M elements and F faces; nothing but samples
/// for a region that is within the tolerance.
void trim_regions(const PreparedMesh& prepared, double tolerance, const RunContext& context,
                  std::vector<FoundRegion>& regions, Explanation* explanation = nullptr,
                  const std::function<bool()>& late = {});

}  // namespace orbifit

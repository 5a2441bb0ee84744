#pragma once

#include <functional>
#include <vector>

#include "orbifit/model/run_context.h"

#include "geometry/surface_index.h"
#include "support/found_region.h"

namespace orbifit {

struct CompletionOptions {
  double tolerance = 0.005;            ///< of the detector, a fraction of the diagonal
  std::size_t most = 300;              ///< regions in all
  Explanation* explanation = nullptr;  ///< may be null
  std::function<bool()> late = {};     ///< whether time is up; may be empty
};

/// Makes the regions a system that the larger ones' groups permute: what lies in a region and is symmetric has images
/// that are symmetric in the same way. Images that were found get exactly the carried group, those that were missed are
/// added once their group is verified; a region that an element maps to itself is moved to where the element leaves it
/// in place. Larger regions go first. Continuous groups carry nothing.
/// \param whole  an index of all faces
void complete_regions(const PreparedMesh& prepared, const SurfaceIndex& whole, const CompletionOptions& options,
                      const RunContext& context, std::vector<FoundRegion>& regions);

/// The placement of the group conjugated by the motion: that of the image of a region.
GroupPlacement carried(const GroupPlacement& placement, const Motion& motion);

}  // namespace orbifit

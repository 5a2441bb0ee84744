#pragma once

#include <memory>
#include <vector>

#include "orbifit/model/run_context.h"

#include "group/refinement.h"
#include "surface/surface_patch.h"

namespace orbifit {

/// The surface around the images of some faces under a group that is roughly known: for a continuous group around the
/// circle or sphere on which they move. Reaches as far as the faces lie from what the group fixes. Triangles that are
/// large against it are cut, so that a small hole in a large plate is seen.
/// \param whole becomes the patch's index, so that images may fall beside the patch
SurfacePatch surroundings(const PreparedMesh& prepared, const std::shared_ptr<const SurfaceIndex>& whole,
                          const GroupPlacement& placement, const std::vector<int>& seeds, double tolerance,
                          const RunContext& context);

}  // namespace orbifit

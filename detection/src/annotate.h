#pragma once

#include <vector>

#include "orbifit/detection/explanation.h"
#include "orbifit/model/annotation.h"
#include "orbifit/model/run_context.h"

#include "support/found_region.h"

namespace orbifit {

/// The regions as an annotation has them: in the frame of the mesh as it was given, largest first, numbered, residuals
/// measured, parents set; without those that are symmetric by coincidence, and those that in the end do not keep nine
/// tenths of their samples. Costs O(F) a region.
/// \param tolerance of the detector, a fraction of the diagonal
std::vector<Region> annotated(const PreparedMesh& prepared, std::vector<FoundRegion> found, double tolerance,
                              const RunContext& context, Explanation* explanation);

}  // namespace orbifit

#pragma once

#include <functional>
#include <vector>

#include "orbifit/detection/explanation.h"
#include "orbifit/model/annotation.h"
#include "orbifit/model/run_context.h"

#include "resolution/coarse_mesh.h"
#include "support/found_region.h"
#include "surface/surface_patch.h"

namespace orbifit {

/// What was found on a prepared mesh: regions in its frame, patterns in that of the mesh from which it was prepared.
struct Findings {
  std::vector<FoundRegion> regions;
  std::vector<Pattern> patterns;
};

struct CarryBackOptions {
  double tolerance = 0.005;            ///< of the detector, a fraction of the diagonal
  int samples = 4000;                  ///< on which the whole mesh is verified
  Explanation* explanation = nullptr;  ///< may be null
  /// Whether a share of the time there is has been spent: the smallest regions are then left out. May be empty.
  std::function<bool(double share)> late = {};
};

/// What was found on a coarse mesh as it holds on the fine one: faces by their proxies, placements and motions
/// refined and verified on the fine mesh, drops what fails there.
/// Costs O(F log F) for each region and pattern, F of its faces.
/// \param coarse of `fine` \param prepared its mesh, made ready
Findings transferred(const PreparedMesh& fine, const CoarseMesh& coarse, const PreparedMesh& prepared, Findings found,
                     const CarryBackOptions& options, const RunContext& context);

}  // namespace orbifit

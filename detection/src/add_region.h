#pragma once

#include <string>
#include <vector>

#include "orbifit/model/annotation.h"

#include "support/found_region.h"
#include "surface/surface_patch.h"

namespace orbifit {

/// What became of a region that was added to an annotation.
struct RegionAddition {
  int id = 0;                         ///< of the new region
  std::vector<std::string> replaced;  ///< "region 4 (C4 on hub)": by their old numbers, regions that it made needless
};

/// Adds a region to an annotation as the detector would have: sorted by area, largest first, numbered anew, parents
/// set. Regions inside the new one whose elements its group holds are left out, as they say nothing more. \param
/// residual of the new region \param tolerance of the detector, a fraction of the diagonal \throw NoResultError when a
/// region of the annotation says all that the new one says; the annotation is unchanged
RegionAddition add_region(const PreparedMesh& prepared, const FoundRegion& added, const Residual& residual,
                          double tolerance, SymmetryAnnotation& annotation);

}  // namespace orbifit

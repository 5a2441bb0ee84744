#pragma once

#include <string>
#include <vector>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"

namespace orbifit {

/// What became of a region that was added to an annotation.
struct RegionAddition {
  int id = 0;                         ///< of the new region
  std::vector<std::string> replaced;  ///< "region 4 (C4 on hub)": by their old numbers, regions that it subsumes
};

/// Adds a region to an annotation as the detector would have: sorted by area, largest first, numbered anew, parents
/// set. Regions inside the new one whose elements its group holds are left out, as the new one subsumes them.
/// \param added  its faces, group, elements, name and residual
/// \param tolerance of the detector, a fraction of the
/// diagonal
/// \throw NoResultError when a region of the annotation subsumes the new one, UsageError when the new one's
/// elements form no group; the annotation is unchanged then
RegionAddition add_region(const Mesh& mesh, const Region& added, double tolerance, SymmetryAnnotation& annotation);

}  // namespace orbifit

#pragma once

#include <vector>

#include "orbifit/fitting/scan_preparation.h"
#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

namespace orbifit {

/// Whether a scan has the symmetry that a fit has kept in a region.
struct GroupAgreement {
  int region = 0;           ///< its id
  int pairs = 0;            ///< places x and g x, both seen by the scan, that were compared
  double disagreement = 0;  ///< root mean square by which the free fit differs between them, of the diagonal
  double held = 0;          ///< root mean square distance of the region's scan points with the group, of the diagonal
  double free = 0;          ///< and without
  bool disagrees = false;   ///< both say so, and of no region around this one
};

/// Compares a fit that keeps the groups with one that keeps none: where the scan has not the symmetry, the free fit
/// moves x and g x differently, and fits better. Places of the free fit that are far from the scan say nothing. Of
/// continuous groups some rotations are tried, about any axis of a sphere. A rigid motion of the region, which would
/// carry its group along, is taken out first. Regions within one that disagrees can be judged once that one is left
/// out. At most 6000 pairs a region, each a nearest-point query: O((regions + P) log F).
/// \param fitted, free  the same template fitted with and without groups, in the scan's frame
/// \param carried  the annotation of `fitted`: see FitResult::annotation
/// \return one for each region, in the same order
std::vector<GroupAgreement> group_agreement(const Mesh& fitted, const Mesh& free, const SymmetryAnnotation& carried,
                                            const PreparedScan& scan, const RunContext& context);

}  // namespace orbifit

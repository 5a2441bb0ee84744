#pragma once

#include <optional>
#include <vector>

#include "orbifit/fitting/group_agreement.h"
#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

#include "scan/scan_preparation.h"

namespace orbifit {

/// Compares a fit that keeps the groups with one that keeps none: where the scan has not the symmetry, the free fit
/// moves x and g x differently, and fits better. Places of the free fit that are far from the scan say nothing. Of
/// continuous groups some rotations are tried, about any axis of a sphere. A rigid motion of the region, which would
/// carry its group along, is taken out first. Regions within one that disagrees can be judged once that one is left
/// out. At most 1000 pairs a region, each a nearest-point query: O((regions + P) log F).
/// \param fitted, free  the same template fitted with and without groups, in the scan's frame
/// \param carried  the annotation of `fitted`: see FitResult::annotation
/// \return one for each region, in the same order
std::vector<GroupAgreement> group_agreement(const Mesh& fitted, const Mesh& free, const SymmetryAnnotation& carried,
                                            const PreparedScan& scan, const RunContext& context);

/// The same without a free fit, where in each region the scan lies so near to the fit with groups that none could
/// disagree: as far as at most half of what a disagreement is, root mean square. The scan's heights over the fit then
/// stand for the free fit's. None where that is not so.
std::optional<std::vector<GroupAgreement>> agreement_beyond_doubt(const Mesh& fitted, const SymmetryAnnotation& carried,
                                                                  const PreparedScan& scan, const RunContext& context);

}  // namespace orbifit

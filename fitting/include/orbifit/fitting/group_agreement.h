#pragma once

namespace orbifit {

/// Whether a scan has the symmetry that a fit has kept in a region.
struct GroupAgreement {
  int region = 0;           ///< its id
  int pairs = 0;            ///< places x and g x, both seen by the scan, that were compared
  double disagreement = 0;  ///< root mean square by which the free fit, or the scan where no fit could disagree,
                            ///< differs between them, of the diagonal
  double held = 0;          ///< root mean square distance of the region's scan points with the group, of the diagonal
  double free = 0;          ///< and without; the same where the scan lies so near that no fit could disagree
  bool disagrees = false;   ///< both say so, and of no region around this one
};

}  // namespace orbifit

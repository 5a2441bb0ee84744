#pragma once

#include <vector>

#include "orbifit/fitting/placement.h"
#include "orbifit/fitting/scan_preparation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"
#include "orbifit/model/run_context.h"

namespace orbifit {

/// A scan in which a template was found, without what is not the template's.
struct PlacedScan {
  PreparedScan scan;
  Similarity pose;                    ///< template -> scan
  std::vector<Placement> placements;  ///< best first; empty where it was not found: then all of the scan, as given
  double used_fraction = 1;           ///< share of the scan's points near those that are left
};

/// Finds the template in a scan (find_placements), and leaves of the scan what may be its: what is near, without planes
/// that the template does not explain.
/// \param given  rough pose: where the best placement is much the same, its scale is kept
/// \throw InputError as prepare_scan() does
PlacedScan place_in_scan(const Mesh& mesh, const PointCloud& cloud, const Similarity& given,
                         const PlacementOptions& options, const ScanPreparationOptions& preparation,
                         const RunContext& context);

}  // namespace orbifit

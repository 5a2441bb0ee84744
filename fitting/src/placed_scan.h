#pragma once

#include <memory>
#include <optional>

#include "orbifit/fitting/placement.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"
#include "orbifit/model/run_context.h"

#include "registration/correspondences.h"
#include "scan/scan_preparation.h"
#include "solver/scan_views.h"

namespace orbifit {

/// A placement of a template, and what of the scan may be the template's there.
struct PlacedScan {
  PreparedScan scan;
  Similarity pose;          ///< template -> scan
  double overlap = 1;       ///< share of the scan's points near those that are left
  double torn_off = 0;      ///< share that is not, being far from the template, but hangs together with those
  bool scale_open = false;  ///< nothing is known of the scale: the pose's is that of the template as it is
  std::shared_ptr<const ScanViews> views = {};  ///< of the template and this scan
};

/// Leaves of the scan what may be the template's in a pose: what is near, without planes that it does not explain.
/// \param surface  the template's \param given  rough pose: where the placement is much the same, its scale is kept
/// \return none where all of the scan is of something else \throw InputError as prepare_scan() does
std::optional<PlacedScan> placed_scan(const MatchSurface& surface, const PointCloud& cloud, const Similarity& pose,
                                      const Similarity& given, const PlacementOptions& options,
                                      const ScanPreparationOptions& preparation, const RunContext& context);

}  // namespace orbifit

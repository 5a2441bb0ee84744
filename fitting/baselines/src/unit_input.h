#pragma once

#include "orbifit/baselines/kurz.h"
#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"
#include "orbifit/model/run_context.h"

#include "scan/scan_preparation.h"

namespace orbifit {

/// The template with a longest side of 1 about the origin, and the scan as it is placed.
struct UnitInput {
  Similarity unit;  ///< template -> unit template
  Similarity pose;  ///< unit template -> scan
  Mesh mesh;
  SymmetryAnnotation annotation;
  PreparedScan scan;       ///< in the scan's frame; no points: handles alone
  Points points, normals;  ///< the scan's, in the unit template's frame
};

/// \throw InputError for a template without extent, a scan of too few points, or none of them and no handles either
UnitInput unit_input(const FitInput& input, const KurzOptions& options, const RunContext& context);

}  // namespace orbifit

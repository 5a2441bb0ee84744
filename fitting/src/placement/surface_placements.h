#pragma once

#include <optional>
#include <vector>

#include "orbifit/fitting/placement.h"
#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

#include "registration/correspondences.h"

namespace orbifit {

/// find_placements() of a template whose surface is at hand.
std::vector<Placement> find_placements(const MatchSurface& surface, const SymmetryAnnotation& annotation,
                                       const PointCloud& scan, const PlacementOptions& options,
                                       const RunContext& context, const std::optional<Similarity>& given = {});

}  // namespace orbifit

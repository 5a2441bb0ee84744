#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "orbifit/model/run_context.h"

#include "group/candidates.h"
#include "group/refinement.h"
#include "group/verification.h"
#include "surface/surface_patch.h"

namespace orbifit {

/// Directions known from elsewhere, such as the axes of the whole or of neighbouring parts.
struct GroupHints {
  std::vector<Eigen::Vector3d> axes;
};

/// A verified group of a patch.
struct OwnGroup {
  GroupPlacement placement;
  Verification verification;
};

/// How much of the patch the group keeps: verify() at continuous_tolerance() for a continuous group and at the patch's
/// own tolerance for a finite one, given up where it is far less than passes() asks for.
/// \param samples how many of the patch's samples to use, spread evenly; 0: all
Verification verify_group(const SurfacePatch& patch, const GroupPlacement& placement, const RunContext& context,
                          int samples = 0);

/// Whether that passes().
bool verified(const SurfacePatch& patch, const GroupPlacement& placement, const RunContext& context, int samples = 0);

/// The largest point group that maps the patch to itself: candidates for mirrors and axes, the orders about each axis,
/// whole group templates refined jointly and verified element by element, largest first. Nothing for an asymmetric
/// patch. \param screen directions to search exhaustively; null: the principal axes only
std::optional<OwnGroup> find_own_group(const SurfacePatch& patch, const DirectionSet* screen, const GroupHints& hints,
                                       const RunContext& context);

}  // namespace orbifit

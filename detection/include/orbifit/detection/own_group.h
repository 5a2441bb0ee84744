#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "orbifit/detection/candidates.h"
#include "orbifit/detection/refinement.h"
#include "orbifit/detection/surface_patch.h"
#include "orbifit/detection/verification.h"
#include "orbifit/model/run_context.h"

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

/// The largest point group that maps the patch to itself: candidates for mirrors and axes, the orders about each axis,
/// whole group templates refined jointly and verified element by element, largest first. Nothing for an asymmetric
/// patch. \param screen directions to search exhaustively; null: the principal axes only
std::optional<OwnGroup> find_own_group(const SurfacePatch& patch, const DirectionSet* screen, const GroupHints& hints,
                                       const RunContext& context);

/// Orders n >= 2 such that the rotation by 2 pi / n about the axis through `centre` keeps the patch, descending, judged
/// coarsely (`slack` tolerances, few samples). Orders whose step is too small to tell from none are left out.
std::vector<int> rotation_orders(const SurfacePatch& patch, const Eigen::Vector3d& axis, const Eigen::Vector3d& centre,
                                 double slack);

/// Whether every rotation about the axis keeps the patch, facets allowed for: their sagitta must stay below the
/// continuous tolerance. Judged coarsely, on a few angles.
bool continuous_about(const SurfacePatch& patch, const Eigen::Vector3d& axis, const Eigen::Vector3d& centre,
                      const RunContext& context);

/// The tolerance at which a continuous group of the patch is judged, a length: the relative tolerance at the scale of
/// the patch itself, so that a small faceted part is not called round because the mesh is large.
double continuous_tolerance(const SurfacePatch& patch);

}  // namespace orbifit

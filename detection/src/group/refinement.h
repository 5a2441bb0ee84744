#pragma once

#include <Eigen/Core>

#include "orbifit/model/point_group.h"
#include "orbifit/model/run_context.h"

#include "surface/surface_patch.h"

namespace orbifit {

/// Where a group sits: its elements follow in closed form.
struct GroupPlacement {
  PointGroup group;
  GroupFrame frame = GroupFrame::Identity();
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
};

struct RefinementOptions {
  int samples = 400;       ///< of the patch
  int iterations = 12;     ///< at most
  double first_width = 4;  ///< reach of the robust loss at the start, in tolerances of the patch
  double last_width = 1;   ///< and at the end
};

/// Moves frame and centre, all elements of the group together, so that the images of the patch's samples come to lie on
/// the patch: point-to-plane least squares with Tukey's loss, whose reach shrinks, at once where a step moves it by
/// less than a fiftieth of the tolerance; it ends where one moves it by less than a ten thousandth. The group itself
/// stays exact.
GroupPlacement refine(const SurfacePatch& patch, const GroupPlacement& start, const RunContext& context,
                      const RefinementOptions& options = {});

/// Where the vertices of the patch are images of one another, lets them decide: point-to-point least squares, which
/// leaves no more than rounding. Of a continuous group, which facets have by halves, thirds, fifths or sevenths of a
/// turn only, these decide. Returns `start` unchanged where they are not.
GroupPlacement refine_on_vertices(const SurfacePatch& patch, const GroupPlacement& start);

}  // namespace orbifit

#pragma once

#include <optional>
#include <vector>

#include "orbifit/model/run_context.h"

#include "surface/surface_patch.h"

namespace orbifit {

/// Components that are copies of one another.
struct CongruenceClass {
  std::vector<int> members;     ///< component numbers, ascending
  std::vector<Motion> motions;  ///< from the first member to each, the identity first; proper where one fits
};

struct ComponentSurvey {
  std::vector<SurfaceMoments> moments;   ///< of each component
  std::vector<CongruenceClass> classes;  ///< by the area of all members together, descending
};

/// Sorts the components into congruence classes: rigid invariants (area, principal variances, radius) first, then an
/// aligning motion for each member, by matching vertex order, moment frames with all signs, or sampled turns where
/// moments leave the frame open; each refined by point-to-plane ICP and verified within the parts' tolerance.
/// Components below `least_share` of the mesh's area each go unsurveyed unless copies together exceed it.
ComponentSurvey survey_components(const PreparedMesh& prepared, double tolerance, double least_share,
                                  const RunContext& context);

/// A motion that carries `part` onto `patch` (det +1 preferred), verified; nothing when they are not congruent.
std::optional<Motion> align(const SurfacePatch& patch, const PreparedMesh& prepared, const std::vector<int>& part,
                            const SurfaceMoments& part_moments, const RunContext& context);

/// Moves a motion that all but carries the patch onto `part` to where it does: where the two name their corners in the
/// same order, to rounding; else by point-to-plane ICP within two tolerances.
Motion refined_motion(const SurfacePatch& patch, const PreparedMesh& prepared, const std::vector<int>& part,
                      const Motion& start);

}  // namespace orbifit

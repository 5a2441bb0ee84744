#pragma once

#include <optional>
#include <vector>

#include "orbifit/model/point_group.h"
#include "orbifit/model/run_context.h"

#include "group/candidates.h"
#include "surface/surface_patch.h"

namespace orbifit {

/// A group that the whole mesh has at a larger tolerance only, as a fraction of its diagonal.
struct LargerToleranceGroup {
  PointGroup group;
  double tolerance;
};

/// Scans and what is made by hand are off by more than the usual tolerance: at twice and four times the tolerance, the
/// groups that are larger than the one before.
/// \param has     the whole's group at the tolerance; nothing where it has none
/// \param screen  as for find_own_group()
std::vector<LargerToleranceGroup> groups_at_larger_tolerance(const PreparedMesh& prepared,
                                                             const std::optional<PointGroup>& has, double tolerance,
                                                             const DirectionSet& screen, const RunContext& context);

}  // namespace orbifit

#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "search/axis_regions.h"

namespace orbifit {

/// The finite group that two generate together, where all elements of both leave one point where it is: the common
/// point nearest to `near`, all in one frame. A mirror and a half-turn about an axis in it make C2v. Elements that
/// differ by less than 3 degrees, or else 6, or 12, count as one; they are averaged to a group, so that fits that agree
/// roughly do. \param tolerance a length, by which elements may miss the point \return nothing for continuous groups,
/// where there is no such point, where one group holds the other, and where the two generate no finite group of at most
/// 120 elements
std::optional<GroupPlacement> joined_group(const GroupPlacement& a, const GroupPlacement& b,
                                           const Eigen::Vector3d& near, double tolerance);

/// Regions of the larger groups that pairs of found regions' groups generate, wherever these end: where a part is
/// missing, mirrors keep more of a shape than the group that they make up. \param known regions found before, whose
/// groups are joined; what they say is not repeated \param turning see AxisRegions
/// Costs O(R^2) products of groups for R regions, O(S N) grid look-ups for S samples and N elements a joined group,
/// then the verification of what keeps enough.
std::vector<FoundRegion> find_joined_groups(const ScreenedSurface& surface, const SurfaceIndex& whole,
                                            const std::vector<Line>& turning, const std::vector<FoundRegion>& known,
                                            const LineRegionOptions& options, const RunContext& context);

}  // namespace orbifit

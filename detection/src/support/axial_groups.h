#pragma once

#include <vector>

#include "primitives/revolution.h"
#include "support/grid_region.h"

namespace orbifit {

/// A group about an axis that some samples of a surface speak for.
struct AxialGroup {
  GroupPlacement placement;
  int kept = 0;  ///< samples that all its elements keep
};

/// Larger groups than Cn about an axis, those with mirrors: Cnv, Cnh, Dnh and Dnd. Angles of vertical mirrors and
/// heights of the middle are tried one by one, a tolerance apart.
/// \param samples numbers of the samples that the rotations by 1/n of a turn keep, and that speak for them
/// \param kept all that they keep: planes across the axis say where a middle is, if nothing else
/// \param least_share of all the surface's samples that a group must keep
/// \return the largest groups first, of equal ones those that keep more
std::vector<AxialGroup> larger_groups(const ScreenedSurface& surface, const Line& axis, int n,
                                      const std::vector<int>& samples, const std::vector<int>& kept,
                                      double least_share);

/// Dinfh at the heights across which most of some samples are mirrored.
/// \param samples those that all rotations about the axis keep \param least_share of all the surface's samples
std::vector<GroupPlacement> groups_with_middle(const ScreenedSurface& surface, const Line& axis,
                                               const std::vector<int>& samples, double least_share);

}  // namespace orbifit

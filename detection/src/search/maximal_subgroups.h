#pragma once

#include <vector>

#include "search/axis_regions.h"

namespace orbifit {

/// For regions of finite groups G, the subgroups H of at least a quarter of their elements that keep materially more of
/// the surface than any larger subgroup does, wherever that ends: the lattice of (H, S(H)), S(H) = {x : h x is on the
/// surface for all h in H}. A toothed rim of Dnh on a hub that no half-turn keeps makes a region of Cnv. What is only
/// flat, or slides along itself, counts as more where all of its piece belongs. \param regions those whose subgroups
/// are wanted \param known regions found before; what they say is not repeated \param turning see AxisRegions Costs O(S
/// N) grid look-ups for S samples and N elements a region, then the verification of what is found.
std::vector<FoundRegion> find_wider_subgroups(const ScreenedSurface& surface, const SurfaceIndex& whole,
                                              const std::vector<FoundRegion>& regions, const std::vector<Line>& turning,
                                              const std::vector<FoundRegion>& known, const LineRegionOptions& options,
                                              const RunContext& context);

}  // namespace orbifit

#pragma once

#include <functional>
#include <vector>

#include "orbifit/detection/explanation.h"
#include "orbifit/model/run_context.h"

#include "primitives/revolution.h"
#include "support/found_region.h"
#include "support/grid_region.h"

namespace orbifit {

struct LineRegionOptions {
  double least_share = 0.002;          ///< of the mesh's area that speaks for a region: less says little
  Explanation* explanation = nullptr;  ///< notes are added to it; may be null
  std::function<bool()> late;          ///< whether time is up; may be empty
  /// That keep the whole mesh, in its normalised frame: what is found at one place has images at others. May be empty.
  std::vector<Motion> of_whole = {};
};

struct AxisRegions {
  std::vector<FoundRegion> regions;
  std::vector<Line> turning;  ///< the axes about which at least 1 % of the surface turns by any angle
};

/// Regions of finite rotation groups about given axes, by the orbit test on the surface itself: wherever a rotation by
/// 1/n of a turn and its powers keep the surface, whatever pieces it is cut into. Orders are found by climbing from n
/// to its multiples on samples; what all rotations keep speaks for no order, nor does what slides along itself unless a
/// piece turns as a whole. Each region is refined, given the largest group that it has, and verified.
/// What is shaped as turned about one of the axes says nothing of motions that leave that axis in place.
/// \param whole index of the whole mesh \param known regions found before; what they say is not repeated
/// Costs about 30 grid look-ups a sample and axis, then the search of an own group a region.
AxisRegions find_axis_regions(const ScreenedSurface& surface, const SurfaceIndex& whole, const std::vector<Line>& axes,
                              const std::vector<FoundRegion>& known, const LineRegionOptions& options,
                              const RunContext& context);

}  // namespace orbifit

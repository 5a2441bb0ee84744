#pragma once

#include <vector>

#include "primitives/symmetry_lines.h"
#include "search/axis_regions.h"

namespace orbifit {

/// Planes in which much of the surface is mirrored: each pair of samples whose normals are mirror images in the plane
/// between them votes, and planes are judged on few samples first. Finds mirrors of surfaces that have no pieces, and
/// of parts of surfaces. Through axes about which the surface turns, planes are tried angle by angle, on what does not
/// turn: a handle on a cup says which.
/// \param turning such axes, see AxisRegions: what is shaped like that says nothing of planes that hold the axis
/// \param least_share of the samples that a plane must keep
/// \return through the line's point, across its direction; those that hold an axis first, axis by axis, then the
/// others; of either the heaviest first; in the frame of the mesh; weights are areas Costs O(N^2) comparisons for N =
/// 700 samples, some grid look-ups for the pairs that agree, and up to 400 for each of O(radius / tolerance) angles an
/// axis.
std::vector<CandidateLine> mirror_planes(const ScreenedSurface& surface, const std::vector<Line>& turning,
                                         double least_share, const RunContext& context);

/// Regions of mirrors in given planes, by the orbit test on the surface itself. What slides along the mirror's normal
/// speaks for none.
/// \param whole index of the whole mesh \param turning see mirror_planes()
/// \param known regions found before; what they say is not repeated
std::vector<FoundRegion> find_plane_regions(const ScreenedSurface& surface, const SurfaceIndex& whole,
                                            const std::vector<CandidateLine>& planes, const std::vector<Line>& turning,
                                            const std::vector<FoundRegion>& known, const LineRegionOptions& options,
                                            const RunContext& context);

}  // namespace orbifit

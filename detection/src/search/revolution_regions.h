#pragma once

#include <functional>
#include <vector>

#include "orbifit/detection/explanation.h"
#include "orbifit/model/run_context.h"

#include "primitives/symmetry_lines.h"
#include "support/found_region.h"

namespace orbifit {

struct RevolutionRegionOptions {
  double tolerance = 0.005;    ///< fraction of the mesh's diagonal
  double least_share = 0.002;  ///< of the mesh's area: smaller regions say little
  /// Whether nearly all is one finely meshed surface: axes are then fitted and faces collected in turns. Parts that are
  /// modelled as such have no axis but their own.
  bool fine = false;
  Explanation* explanation = nullptr;  ///< may be null
  std::function<bool()> late;          ///< whether time is up; may be empty
  /// That keep the whole mesh, in its normalised frame: what is found at one place has images at others. May be empty.
  std::vector<Motion> of_whole = {};
};

struct RevolutionRegions {
  std::vector<FoundRegion> regions;
  std::vector<Line> axes;  ///< of what turned but was little else than discs of planes that go on beyond it
};

/// Turned regions that end within a piece of surface, where other things are joined to it: for each axis the faces
/// whose whole circles lie on the surface (the orbit test, docs/method.md 6), then the largest group of what they make
/// up. Of a plane nearly all within its creases is taken, or what turns if the plane ends where the region goes on, or
/// nothing: a disc on a larger plane is no part of anything. Costs O(F) cheap tests an axis, and 12 to 48 nearest-point
/// queries a face of the region.
/// \param prepared with pieces of surface between creases for components \param whole index of the whole mesh
/// \param axes where to look \param known regions found before; what they say is not repeated
RevolutionRegions find_revolution_regions(const PreparedMesh& prepared, const SurfaceIndex& whole,
                                          const std::vector<Line>& axes, const std::vector<FoundRegion>& known,
                                          const RevolutionRegionOptions& options, const RunContext& context);

/// Axes about which large parts of the pieces of surface turn: robust fits to each piece, and to surroundings of points
/// spread over the pieces that no fit explains.
std::vector<Line> revolution_axes(const PreparedMesh& prepared, double tolerance, const RunContext& context);

}  // namespace orbifit

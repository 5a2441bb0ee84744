#pragma once

#include <array>
#include <vector>

#include "orbifit/model/run_context.h"

#include "group/refinement.h"
#include "group/verification.h"
#include "primitives/balls.h"
#include "surface/face_sides.h"
#include "surface/surface_ends.h"
#include "surface/surface_grid.h"
#include "surface/surface_patch.h"

namespace orbifit {

/// The surface cut into pieces, with a grid to ask where it is and samples spread over it.
struct ScreenedSurface {
  /// \param prepared with pieces of surface between creases for components; kept by reference
  /// \param tolerance of the detector, a fraction of the diagonal
  ScreenedSurface(const PreparedMesh& prepared, double tolerance, int sample_count, const RunContext& context);

  const PreparedMesh& prepared;
  double tolerance;
  SurfaceGrid grid;
  SurfaceSamples samples;
  std::vector<int> piece_of_sample;
  std::vector<double> piece_areas;
  std::vector<int> faces;  ///< those with area, ascending
  /// Edges of faces of flat pieces: the other face of the piece there, -1 where the piece ends.
  struct FlatEdge {
    int face, other;
    double length;
    Eigen::Vector3d middle;
  };
  std::vector<FlatEdge> flat_edges;
  std::vector<char> piece_flat;  ///< by piece: a part of one plane
  Balls balls;
  std::vector<std::array<FaceSide, 3>> sides;  ///< of all faces
  SurfaceEnds ends;
};

/// The maximal region of a group, S(G) = {x : g x is on the surface for all g in G}, roughly: by the grid, so to a
/// tolerance or two. Of a flat piece only what ends where the piece does is taken: a disc on a larger plane is no part
/// of anything. Pieces of which nearly all belongs are taken in full.
/// Costs O(F M) grid look-ups for the M elements that judge the group.
/// \return ascending
std::vector<int> grid_region(const ScreenedSurface& surface, const GroupPlacement& placement,
                             const RunContext& context);

/// Of a region's faces those whose images lie on the region itself, to its own tolerance: what the grid let through, or
/// what lost its images, leaves. Only pieces of which the verification saw samples fail are looked at.
/// \param verification of the patch under the placement \return ascending
std::vector<int> thinned_region(const ScreenedSurface& surface, const SurfacePatch& patch,
                                const Verification& verification, const GroupPlacement& placement,
                                const RunContext& context);

}  // namespace orbifit

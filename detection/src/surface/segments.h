#pragma once

#include <vector>

#include "surface/surface_patch.h"

namespace orbifit {

struct SegmentOptions {
  double crease = 25;         ///< degrees between neighbouring faces from which an edge is a crease, in (0, 180)
  double least_share = 2e-4;  ///< of the mesh's area: smaller segments join the neighbour with which they share most
};

/// Cuts the surface along its creases: faces are in one segment where a chain of edges leads from one to the other none
/// of which is a crease, a border, or shared by more than two faces. Faces without area follow their neighbours.
/// Segments are numbered by first appearance; no segment spans two components. Costs O(F log F).
Components smooth_segments(const PreparedMesh& prepared, const SegmentOptions& options = {});

/// Whether nine tenths of the faces' area look one way, to 5 degrees: a part of a plane, perhaps with rounded edges.
bool flat_piece(const PreparedMesh& prepared, const std::vector<int>& faces);

}  // namespace orbifit

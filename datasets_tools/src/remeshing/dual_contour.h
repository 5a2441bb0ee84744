#pragma once

#include <array>
#include <vector>

#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

#include "remeshing/union_scan.h"

namespace orbifit {

/// A surface of quadrangles that separates the inner nodes of a grid from the outer ones, in the grid's frame.
struct DualSurface {
  Points vertices;                        ///< #V by 3
  std::vector<std::array<int, 4>> quads;  ///< counterclockwise as seen from outside
  std::vector<Eigen::Vector3d>
      crossings;  ///< #quads: where the grid's edge that a quadrangle surrounds meets the surface
};

/// Dual contouring (Ju et al. 2002): in each cell a vertex where the planes of the surface that its edges cross meet,
/// within the cell; one for each sheet (Nielson 2004), such that every edge has two quadrangles (Wenger 2013,
/// section 3.4).
/// \param normals  of the scan's faces, in the grid's frame, #F by 3
DualSurface dual_contour(const UnionScan& scan, const Points& normals, RunContext& context);

}  // namespace orbifit

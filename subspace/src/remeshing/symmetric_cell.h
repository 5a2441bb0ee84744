#pragma once

#include <vector>

#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

#include "remeshing/finite_group.h"
#include "remeshing/glued_images.h"

namespace orbifit {

/// The triangles of a cell, with one vertex a place.
struct CellSurface {
  std::vector<Eigen::Vector3d> points;
  std::vector<std::array<int, 3>> triangles;
  std::vector<int> sources;  ///< faces of the mesh
};

struct CellCut {
  double snap = 0.2;
  double reach = 0;     ///< mesh units: how far from the group the surface may be
  double diagonal = 0;  ///< of the mesh, mesh units
};

/// The cell made anew so that the group maps its vertices and triangles onto one another. Its `sources` are faces of
/// the mesh.
/// \throw NoResultError where no domain's sides can be welded
GluedImages symmetric_cell(const CellSurface& cell, const FiniteGroup& group, const CellCut& cut,
                           const RunContext& context);

}  // namespace orbifit

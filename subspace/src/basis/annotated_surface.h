#pragma once

#include <vector>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

#include "sampling/border_points.h"
#include "symmetry/region_map.h"

namespace orbifit {

/// What the subspaces of one annotated mesh have in common, however fine they are.
struct AnnotatedSurface {
  /// \param context  hears of patterns, as RegionMap does
  AnnotatedSurface(const Mesh& mesh, const SymmetryAnnotation& annotation, const RunContext& context)
      : regions(mesh, annotation, context), borders(mesh, regions) {}

  RegionMap regions;
  AbuttingPlaces borders;
  std::vector<int> vertex_sets;  ///< closed_sets_of_vertices(), once they were asked for; else empty
};

}  // namespace orbifit

#pragma once

#include <optional>
#include <vector>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"
#include "orbifit/subspace/symmetric_remesh.h"

#include "geometry/topology.h"
#include "remeshing/cells.h"

namespace orbifit {

/// The demands of an annotation, regions first.
struct AnnotationDemands {
  std::vector<SymmetricRemeshItem> items;  ///< of each region, then of each pattern
  std::vector<Region> finite;              ///< of each region: with the finite group that stands for a continuous one
  std::vector<Demand> demands;             ///< of each item; without motions where it is left out
  std::vector<std::vector<std::vector<int>>> components;  ///< of each item: those of a region, or of each instance
};

/// \param min_score  see SymmetricRemeshOptions; patterns are not judged
/// \throw NoResultError naming the region whose score is below it
AnnotationDemands annotation_demands(const Mesh& mesh, const Components& components,
                                     const SymmetryAnnotation& annotation, double min_score, const RunContext& context);

}  // namespace orbifit

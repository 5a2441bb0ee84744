#pragma once

#include <array>
#include <vector>

#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

#include "surface/vertex_clusters.h"

namespace orbifit {

/// A fine mesh, and the coarse one that its clusters of sites make.
struct ClusteredMesh {
  using Corners = std::array<int, 3>;  ///< clusters

  const PreparedMesh& fine;
  const Sites& sites;                ///< of the fine mesh
  std::vector<int> cluster_of_site;  ///< vertices of `mesh`
  Mesh mesh;

  Corners corners_of(int face) const;  ///< the clusters of a fine face's corners
};

/// Finds the coarse face that stands for each fine face whose corners came together in one cluster or two: the nearest
/// at those clusters, with regard to the normal; where there is none, that of a neighbour. Costs O(F).
/// \param proxy_face  by fine face: the coarse one, -1 where it is to be found
void complete_proxy_faces(const ClusteredMesh& clustered, const RunContext& context, std::vector<int>& proxy_face);

}  // namespace orbifit

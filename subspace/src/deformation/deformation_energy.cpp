#include "deformation/deformation_energy.h"

#include "basis/subspace_parts.h"
#include "deformation/laplacian.h"
#include "deformation/mesh_laplacian.h"
#include "deformation/point_laplacian.h"

namespace orbifit {

Corotation deformation_energy(const Subspace& subspace, const Mesh& mesh, LaplacianKind kind,
                              const RunContext& context) {
  const Points& samples = subspace->sampling.points;
  const SampleEdges edges = neighbour_graph(samples, subspace->sampling.radii);
  switch (kind) {
    case LaplacianKind::cotangent:
      return corotation(samples, edges,
                        cotangent_sample_laplacian(mesh, samples, subspace->sampling.radius, edges, context));
    case LaplacianKind::point:
      return corotation(samples, edges, point_laplacian(samples, edges));
    default:
      return corotation(samples, edges, graph_laplacian(edges, samples.rows()));
  }
}

}  // namespace orbifit

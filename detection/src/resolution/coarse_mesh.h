#pragma once

#include <optional>
#include <vector>

#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

#include "geometry/topology.h"
#include "surface/surface_patch.h"

namespace orbifit {

/// A coarse mesh that stands for a fine one.
struct CoarseMesh {
  Mesh mesh;                    ///< in the frame of the prepared mesh; components in its order, one each
  std::vector<int> proxy_face;  ///< by face of the fine mesh: the face of `mesh`, of its component, that is where it is
};

struct CoarseMeshOptions {
  double tolerance = 0.005;  ///< of the detector, a fraction of the diagonal
  double noise = 0;          ///< standard deviation that was in the vertices, in diagonals; some of it is left
  double most_faces = 0.5;   ///< of the fine mesh's: with more nothing is gained
};

/// A mesh with as few faces as the tolerance asks for: vertices are clustered in cells of two tolerances where the
/// surface is flat or creased, and of less where it bends, to about a tenth of a tolerance (vertex_clusters). Small
/// components have smaller tolerances, as patches have. Components that would vanish, fall apart or meet others stay as
/// they are; soups, doubled and degenerate faces, edges of many faces are all welcome.
/// Costs O(F log F). \return nothing where nothing is gained
std::optional<CoarseMesh> coarse_mesh(const PreparedMesh& prepared, const CoarseMeshOptions& options,
                                      const RunContext& context);

/// Pieces of the fine mesh as the coarse one has them: each coarse face is in the piece that has most of the area for
/// which it stands. Pieces keep their order; those that are left with nothing are left out. Costs O(F log F).
Components transferred_pieces(const Components& pieces, const PreparedMesh& fine, const CoarseMesh& coarse);

}  // namespace orbifit

#pragma once

#include <string>
#include <vector>

#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"
#include "orbifit/model/run_context.h"

#include "batch/collection.h"

namespace orbifit::batch {

/// Items whose meshes are the same.
struct SameShapes {
  /// Per item of the collection, the number of the first one that has the same file, byte for byte; its own number
  /// where it is that one or has no mesh.
  std::vector<std::size_t> same_file;
  /// Likewise the first one that is the same up to a similarity.
  std::vector<std::size_t> same_shape;
};

/// Candidates are items with the same invariants (shape_invariants.h), confirmed by laying one surface on the other.
/// The meshes are read where several share their invariants; one that is no longer there is taken to equal no other.
/// \param tolerance  largest distance between the surfaces, as a fraction of the diagonal, above 0
SameShapes find_same_shapes(const Collection& collection, double tolerance, const RunContext& context);

/// Whether a similarity, mirrored or not, takes each mesh's vertices onto the other's surface to within `tolerance` of
/// the diagonal. It is looked for among those that take the centroids onto one another and either two vertices that are
/// told from the others by their distances to two vertices of the other mesh, or the principal axes.
bool same_up_to_similarity(const Mesh& a, const Mesh& b, double tolerance);

}  // namespace orbifit::batch

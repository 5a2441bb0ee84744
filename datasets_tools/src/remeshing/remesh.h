#pragma once

#include <vector>

#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

namespace orbifit {

struct RemeshOptions {
  double cell = 1.0 / 110;  ///< width of a cell of the grid, fraction of the mesh's diagonal, in [1/600, 1/10]
  int fitting_passes = 4;   ///< of vertices to the surface, in [0, 20]; 0 leaves creases cut off by up to half a cell

  void validate() const;  ///< \throw UsageError
};

struct Remeshed {
  Mesh mesh;  ///< one surface, closed, consistently oriented, outward normals; no vertex is used by two sheets
  /// #F of `mesh`: the face of the original nearest to the new face's centroid among those that face the same way.
  std::vector<int> source_face;
};

/// The outer surface of the union of a mesh's closed parts as a new mesh whose triangles know nothing of the parts' own
/// triangles nor of their symmetry: dual contouring (Ju et al. 2002) on a grid in a random place and orientation, drawn
/// from the context's seed; a vertex for each sheet of a cell (Nielson 2004, Wenger 2013); then vertices are fitted to
/// the planes of the surface nearby (Ohtake and Belyaev 2002), so that creases are sharp to a small part of a cell.
///
/// A part is what is connected over edges of the mesh welded at 1e-9 of its diagonal. A point is inside the union when
/// it is inside of any part: winding number other than 0, or odd parity where a part's faces are not consistently
/// oriented. So parts turned inside out count as others. What is enclosed is filled, between parts too. Where every
/// face of a part has a second one that looks the other way, one of the two is taken.
///
/// Creases are met to some hundredths of a cell; those nearer to one another than a cell are rounded. Walls of down to
/// a cell and a half keep their place and both sides; thinner ones are torn into closed pieces or lost, and so are
/// pieces of under 8 cells. Gaps narrower than a cell may close.
///
/// \throw InputError for a mesh without faces, of no size, or with a part that is not closed; it names the part's
/// first face
/// \throw NoResultError when every part is thinner than a cell
Remeshed remesh(const Mesh& mesh, const RemeshOptions& options, RunContext& context);

}  // namespace orbifit

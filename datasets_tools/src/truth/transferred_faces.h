#pragma once

#include <vector>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"
#include "orbifit/model/run_context.h"

#include "detection_score/face_set.h"

namespace orbifit {

/// What is left of a set of faces under motions.
struct KeptFaces {
  std::vector<int> faces;  ///< ascending
  Residual residual;       ///< of the tested centroids' images, over all motions, fractions of the mesh's diagonal
};

/// The faces of `from` whose centroids' images under all the motions are on `to` within the tolerance, with normals
/// that agree to 25 degrees unless next to a crease. Of many motions not every face is tested: what images of a kept
/// face hit is kept.
/// \param motions elements of a group
/// \param sampled whether they are some of infinitely many; then what images of a lost face hit is lost too
/// \param tolerance mesh units
KeptFaces kept_faces(const scoring::MeasuredMesh& measured, const std::vector<int>& from, const std::vector<int>& to,
                     const std::vector<Motion>& motions, bool sampled, double tolerance, const RunContext& context);

/// Whether the faces can slide along themselves, other than by a motion of the region's group: a twist whose velocity
/// has less than a fifteenth across the surface (root mean squares; slippage of Gelfand and Guibas 2004).
/// \param normals of all faces of the mesh, unit, #F by 3
bool slides(const scoring::MeasuredMesh& measured, const Points& normals, const std::vector<int>& faces,
            const Region& region);

/// Whether every element of `smaller` is one of `larger`, to 0.2 % of `size`, and they are not the same group.
bool has_all_elements(const Region& larger, const Region& smaller, double size);

}  // namespace orbifit

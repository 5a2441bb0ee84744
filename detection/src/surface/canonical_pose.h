#pragma once

#include <vector>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"

namespace orbifit {

/// The pose that a mesh has in a frame of its own: coordinates in it are the same, but for rounding, whatever pose and
/// order it is given in; where the mesh has symmetries, up to one of them. The origin is the mean of the faces'
/// corners. The first axis goes through the corner farthest from it, the second towards the one farthest from that
/// axis; of corners that are as far, which symmetries take to one another as a rule, sums over the faces decide.
/// \return what takes the mesh there, a proper motion. O(C F) for C corners as far as the farthest, or 100 of more.
/// \pre coordinates are finite
Motion canonical_motion(const Mesh& mesh);

/// A mesh in its canonical pose and order (CanonicalOrder). Equal coordinates are those that differ by rounding only,
/// so that the order does not depend on the pose either.
struct CanonicalPose {
  Mesh mesh;
  std::vector<int> face_of;  ///< #F: of each of its faces the number in the mesh given
  Motion motion;             ///< takes the mesh given to it
  double stretch = 1;        ///< the given mesh's diagonal over its own: turned, a box has another

  /// O(F log F). \pre coordinates are finite
  explicit CanonicalPose(const Mesh& given);

  /// The mesh given, in its own order, where this one lies.
  Mesh moved(Mesh given) const;

  /// Of the mesh given, what was found of this one: faces ascending, groups and motions where that lies, fractions
  /// those of its diagonal.
  SymmetryAnnotation as_given(const SymmetryAnnotation& annotation, const Mesh& given) const;
};

}  // namespace orbifit

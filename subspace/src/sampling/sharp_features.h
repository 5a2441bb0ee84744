#pragma once

#include "orbifit/model/mesh.h"

#include "geometry/sampling.h"

namespace orbifit {

struct SharpFeatureOptions {
  double spacing = 0;  ///< of points along sharp edges, about; mesh units, > 0
  double angle = 40;   ///< degrees by which the surface, or a sharp edge, must turn to be sharp, in (0, 180)

  void validate() const;  ///< \throw UsageError
};

/// Points for feature-sensitive sampling (paper, section 7): first the corners, where one, three or more sharp edges
/// end or where a sharp edge turns, by vertex; then points along the sharp edges between corners, evenly spaced, so
/// that an edge and its mirror image get the same points whichever way they run. An edge is sharp where the faces at it
/// do not continue one another to within the angle; borders count. Vertices at one place (to 1e-7 of the diagonal)
/// count as one, doubled and two-sided faces too; orientation does not matter.
/// \return none for a smooth closed surface. O(F log F + points)
SurfaceSamples sharp_feature_samples(const Mesh& mesh, const SharpFeatureOptions& options);

}  // namespace orbifit

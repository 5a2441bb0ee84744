#pragma once

#include <vector>

#include "orbifit/apps/render.h"

namespace orbifit {

/// What a view shows of some faces of a mesh.
struct Sight {
  double seen = 0;      ///< of the pixels that the faces would have alone, the share that nothing hides
  double of_shape = 0;  ///< of the pixels of the whole mesh, the share that the faces would have alone
  Eigen::Vector4d box = Eigen::Vector4d::Zero();  ///< around the faces: left, top, width, height in fractions
};

/// Measured in a small picture. \param faces  numbers of the mesh's faces
Sight sight_of(const Mesh& mesh, const std::vector<int>& faces, const ViewOptions& view, const RunContext& context);

/// Whether all of it lies in so small a part of the picture that a close-up helps.
bool is_small(const Sight& sight);

/// Whether so little is seen that all the rest should be glass.
bool mostly_hidden(const Sight& sight);

/// The faces of all instances.
std::vector<int> faces_of(const Pattern& pattern);

}  // namespace orbifit

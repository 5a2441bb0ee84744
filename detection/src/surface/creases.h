#pragma once

#include <Eigen/Core>

#include "surface/surface_patch.h"

namespace orbifit {

/// Whether a point of a face lies within `reach` of a face at one of its corners whose normal differs by more than 25
/// degrees, whichever way the two face: there an image may as well lie on either.
bool near_crease(const PreparedMesh& prepared, const Eigen::Vector3d& point, int face, double reach);

}  // namespace orbifit

#pragma once

#include <Eigen/Core>

#include "orbifit/model/mesh.h"

namespace orbifit {

/// Displacements of points by small rigid motions: orthonormal columns that span them, 3 #P by 6, x y z of the first
/// point first. Fewer where points on one line, or one point alone, leave turns that move nothing. \pre a point or more
Eigen::MatrixXd rigid_modes(const Points& points);

}  // namespace orbifit

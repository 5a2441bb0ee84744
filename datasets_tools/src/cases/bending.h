#pragma once

#include <Eigen/Core>

#include "orbifit/model/mesh.h"

namespace orbifit {

/// How much a deformation bends a surface: by the change of the dihedral angles between faces that share an edge. A
/// rigid motion, a change of scale and a stretch of what is flat bend nothing.
struct Bending {
  double rms = 0;             ///< radians; over the edges, by the area of their two faces at rest
  Eigen::VectorXd of_vertex;  ///< #V: the largest change among its edges, radians
};

/// Edges of other than two faces, and of faces without area, count for nothing.
/// \param rest, deformed  of the same vertices and faces
Bending bending(const Mesh& rest, const Mesh& deformed);

}  // namespace orbifit

#pragma once

#include <vector>

#include <Eigen/Core>

#include "orbifit/model/mesh.h"

namespace orbifit {

/// A unit normal at each corner of each face, 3 #F: the area-weighted mean over the faces around the corner whose
/// planes differ from the corner's own by less than `crease_degrees`, so that curved parts look smooth and edges
/// crisp. Faces wound the other way count with their normals reversed. Zero for degenerate faces.
std::vector<Eigen::Vector3f> corner_normals(const Mesh& mesh, double crease_degrees);

}  // namespace orbifit

#pragma once

#include <vector>

#include <Eigen/Core>

#include "orbifit/model/mesh.h"

namespace orbifit::test {

// Closed, facing outwards.

/// Between two corners; 12 faces, two a side: -x, +x, -y, +y, -z, +z.
Mesh solid_box(const Eigen::Vector3d& low, const Eigen::Vector3d& high);

/// About the origin, from an octahedron whose sides are cut in four `subdivisions` times.
Mesh solid_sphere(double radius, int subdivisions);

/// About z.
Mesh solid_torus(double ring_radius, double tube_radius, int around_ring, int around_tube);

/// All meshes as parts of one, in their order.
Mesh joined_meshes(const std::vector<Mesh>& meshes);

/// Largest distance of points spread over `from` to `to`.
double one_sided_distance(const Mesh& from, const Mesh& to);

}  // namespace orbifit::test

#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

namespace orbifit {

/// A point of a face.
struct FacePoint {
  int face = -1;
  Eigen::Vector3d barycentric = Eigen::Vector3d::Zero();  ///< sums to 1
};

/// Two points of different parts at (nearly) one place.
struct TouchingPoints {
  std::array<int, 2> parts;         ///< of touching_parts(), ascending
  std::array<FacePoint, 2> points;  ///< on either
  Eigen::Vector3d middle;           ///< between them
  Eigen::Vector3d gap;              ///< from the second to the first
};

/// Where parts of a mesh touch: where an edge of one passes through a face of another, and where one has points within
/// a tolerance of another. Looked at are the vertices of both and, where faces are large, points in them. As densely as
/// the mesh is: many points may say of one joint the same. In an order that depends on the mesh alone.
/// \param part_of_face  #F, see touching_parts(): those in one part are not asked
/// \param tolerance mesh units, >= 0: nearer than this is touching
/// \param spacing   mesh units, > 0: of the points looked at within large faces
/// O(F log F), and for each two parts whose boxes meet O(log F) for what they have there
std::vector<TouchingPoints> touching_points(const Mesh& mesh, const std::vector<int>& part_of_face, double tolerance,
                                            double spacing, const RunContext& context);

}  // namespace orbifit

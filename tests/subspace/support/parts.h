#pragma once

#include <utility>
#include <vector>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"

namespace orbifit {

/// A profile (distance from the axis, height) turned about z at the angles given, radians ascending over one round.
/// Ends at distance 0 become poles. Irregular angles leave no rotation that maps vertices onto vertices.
Mesh turned_part(const std::vector<Eigen::Vector2d>& profile, const std::vector<double>& angles);

/// `count` irregular angles.
std::vector<double> irregular_angles(int count);

/// A box with corners at +-half, cut into cells.
Mesh box(const Eigen::Vector3d& half, int cells);

/// A wedge: a box whose upper side is shifted and shrunk so that no motion maps it onto itself.
Mesh wedge(double size);

Mesh placed(const Mesh& mesh, const Motion& motion);

/// Appends a part; returns its faces.
std::vector<int> append(Mesh& mesh, const Mesh& part);

/// A model with one region that is the whole mesh, about z.
GeneratedModel whole(const Mesh& mesh, const PointGroup& group, const Eigen::Vector3d& centre);

}  // namespace orbifit

#pragma once

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "orbifit/model/appearance.h"
#include "orbifit/model/mesh.h"

namespace orbifit::test {

/// How a model's colours are kept.
enum class Paint { vertices, faces, texture };

/// A colour for each point of space, red, green and blue in [0, 1].
using Painter = std::function<Eigen::Vector3d(const Eigen::Vector3d&)>;

/// A look in which the mesh has the painter's colours; in a texture every triangle has a field of its own, of
/// `kField` pixels' side.
Appearance painted(const Mesh& mesh, Paint paint, const Painter& painter);

}  // namespace orbifit::test

#pragma once

#include <string>

#include "gltf_sample.h"

namespace orbifit {

/// A mesh as Draco compresses it: POSITION as attribute 0, a NORMAL of (0, 0, 1) as 1, and TEXCOORD_0, a quarter of x
/// and y, as 2. \param bits  of quantised positions and texture coordinates; 0: all stay floats
std::string draco_bytes(const Mesh& mesh, bool edgebreaker, int bits);

/// A GLB with that.
GltfSample draco_sample(const Mesh& mesh, bool edgebreaker, int bits);

}  // namespace orbifit

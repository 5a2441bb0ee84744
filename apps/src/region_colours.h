#pragma once

#include <vector>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"

namespace orbifit {

/// #F by 3, red, green and blue in [0, 1]: each face in the colour of the smallest region that has it, else clay.
Points region_face_colours(const Mesh& mesh, const std::vector<Region>& regions);

}  // namespace orbifit

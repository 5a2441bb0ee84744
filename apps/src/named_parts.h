#pragma once

#include <string>

#include "orbifit/detection/detect.h"
#include "orbifit/model/mesh.h"

namespace orbifit {

/// What the mesh's file calls the parts of it: objects, or groups where all faces are in one object. Nothing where the
/// file has no names, or what it says besides vertices and faces cannot be read, which is none of detection's business.
NamedParts named_parts(const std::string& file, const Mesh& mesh);

}  // namespace orbifit

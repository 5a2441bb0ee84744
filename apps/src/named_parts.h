#pragma once

#include <string>

#include "orbifit/detection/detect.h"
#include "orbifit/model/appearance.h"
#include "orbifit/model/mesh.h"

namespace orbifit {

/// read_appearance(), or nothing where what the file says besides vertices and faces cannot be read, which is none of
/// the caller's business.
Appearance look_if_readable(const std::string& file, const Mesh& mesh);

/// What the mesh's file calls the parts of it: objects, or groups where all faces are in one object. Nothing where the
/// file has no names.
NamedParts named_parts(const Appearance& look);

}  // namespace orbifit

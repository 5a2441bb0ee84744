#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "orbifit/model/mesh.h"

namespace orbifit {

/// What a mesh file holds besides its triangles, for --json: format, number of sets of UVs, normals, colours, materials
/// with their textures, nodes, unit, and what it names that is missing. What cannot be read is told under `problem`.
nlohmann::ordered_json file_content(const std::string& file, const Mesh& mesh);

}  // namespace orbifit

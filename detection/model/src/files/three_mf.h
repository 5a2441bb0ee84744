#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "files/mesh_builder.h"

namespace orbifit {

/// One use of a mesh by the build of a 3MF file, in the order in which they are read.
struct ThreeMfPart {
  std::string name;             ///< of the object that holds the mesh, else of the nearest that holds this; "" for none
  std::int64_t object = 0;      ///< id of the object with the mesh: parts with the same one are congruent
  std::int64_t first_face = 0;  ///< of the mesh that is read
};

struct ThreeMfContent {
  std::string unit;  ///< of its lengths, in words
  std::int64_t objects = 0, items = 0;
  std::vector<ThreeMfPart> parts;
  std::vector<std::string> warnings;  ///< of lib3mf
};

/// Reads the items of a 3MF file's build, one after the other, each with its transform; of an object of components
/// these, in their order. \throw InputError
ThreeMfContent read_three_mf_content(const std::filesystem::path& file, std::string_view content, MeshBuilder& builder);

}  // namespace orbifit

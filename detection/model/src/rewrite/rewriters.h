#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "orbifit/model/mesh.h"

namespace orbifit {

/// A mesh file and the mesh that it becomes.
struct MeshEdit {
  const std::filesystem::path& source;  ///< for messages, and files beside it
  std::string_view content;             ///< of `source`
  const Mesh& rest;                     ///< as read from it
  const Mesh& edited;                   ///< `rest` with other positions
};

/// The file's bytes with other positions, and normals where it has them; everything else stays as it is.
/// \throw InputError when the format cannot hold a coordinate
std::string rewritten_obj(const MeshEdit& edit);
std::string rewritten_off(const MeshEdit& edit);
std::string rewritten_ply(const MeshEdit& edit);
std::string rewritten_stl(const MeshEdit& edit);
std::string rewritten_gltf(const MeshEdit& edit);

}  // namespace orbifit

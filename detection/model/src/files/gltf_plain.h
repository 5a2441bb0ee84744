#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace orbifit::gltf {

/// A file in plain glTF 2: what a part of the files has besides is written out.
struct Plain {
  std::optional<std::string> changed;  ///< nothing where the file is plain as it stands

  std::string_view text(std::string_view content) const { return changed ? std::string_view(*changed) : content; }
};

/// Primitives that Draco has compressed (KHR_draco_mesh_compression) get accessors with their numbers, sparse accessors
/// of primitives are filled, and the instances of a node (EXT_mesh_gpu_instancing) become its first children; their
/// extensions are not named as used then.
/// \throw InputError
Plain plain(const std::filesystem::path& file, std::string_view content);

}  // namespace orbifit::gltf

#pragma once

#include <filesystem>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "orbifit/model/appearance.h"

namespace orbifit {

/// What a corner does not have.
inline constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// Readers: what a file's `content` tells about the mesh that was read from it. \throw InputError
Appearance obj_look(const std::filesystem::path& file, std::string_view content, const Mesh& mesh);
Appearance ply_look(const std::filesystem::path& file, std::string_view content, const Mesh& mesh);
Appearance gltf_look(const std::filesystem::path& file, std::string_view content, const Mesh& mesh);
Appearance three_mf_look(const std::filesystem::path& file, std::string_view content, const Mesh& mesh);

/// An OBJ file and the material library that it names.
struct ObjFiles {
  std::string mesh, library;
};
ObjFiles obj_with_look(const Mesh& mesh, const Appearance& look, const std::string& library_name);

/// A GLB with a node for each part and a primitive for each material, as they follow one another; a vertex for each
/// that differs in place or look, in the order of the mesh's. \param[out] problems  a line is added for each
std::string glb_with_look(const std::filesystem::path& file, const Mesh& mesh, const Appearance& look,
                          std::vector<std::string>& problems);

/// Whether the name of a file stays within the folder that it is looked for in.
bool within_folder(const std::filesystem::path& name);

/// Reads the image that a material names, from the mesh's folder; warns where it cannot.
void read_image(const std::filesystem::path& folder, Material& material, std::vector<std::string>& warnings);

/// "image/png", "image/jpeg", or "" for other bytes.
std::string image_type(std::string_view bytes);

}  // namespace orbifit

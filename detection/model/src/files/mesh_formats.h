#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "orbifit/model/mesh.h"

#include "files/mesh_builder.h"

namespace orbifit {

// Readers: `content` is the file's bytes. What they find goes into the builder, which names the file in its messages.
// \throw InputError
void read_obj(std::string_view content, MeshBuilder& builder);
void read_off(std::string_view content, MeshBuilder& builder);
void read_ply_mesh(std::string_view content, MeshBuilder& builder);
void read_stl(std::string_view content, MeshBuilder& builder);
void read_gltf(const std::filesystem::path& file, std::string_view content, MeshBuilder& builder);
void read_three_mf(const std::filesystem::path& file, std::string_view content, MeshBuilder& builder);

// Writers: the file's bytes. `file` is for messages. \throw InputError when the format cannot hold a coordinate
std::string obj_text(const Mesh& mesh);
std::string off_text(const Mesh& mesh);
std::string ply_bytes(const Mesh& mesh, const std::optional<Points>& colours);
std::string stl_bytes(const std::filesystem::path& file, const Mesh& mesh);
std::string glb_bytes(const std::filesystem::path& file, const Mesh& mesh);

/// The file's ending in lower case; for standard input without one, what the content looks like.
std::string format_ending(const std::filesystem::path& file, std::string_view content);

/// The reader for an ending, or null.
using MeshReader = void (*)(const std::filesystem::path& file, std::string_view content, MeshBuilder& builder);
MeshReader mesh_reader(const std::string& ending);

/// \throw InputError when a number is too large for single precision
float to_float(const std::filesystem::path& file, double value);

}  // namespace orbifit

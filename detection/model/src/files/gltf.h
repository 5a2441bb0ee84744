#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace orbifit::gltf {

inline constexpr std::uint32_t kMagic = 0x46546C67;      // "glTF"
inline constexpr std::uint32_t kJsonChunk = 0x4E4F534A;  // "JSON"
inline constexpr std::uint32_t kBinChunk = 0x004E4942;   // "BIN"

/// Types of numbers in a buffer.
enum Component { kByte = 5120, kUnsignedByte, kShort, kUnsignedShort, kUnsignedInt = 5125, kFloat };

/// One use of a primitive by a node, in the order in which their vertices are read.
struct PrimitiveUse {
  std::int64_t node = 0, mesh = 0, primitive = 0;
  std::int64_t first_vertex = 0;  ///< of the mesh that is read
  Eigen::Matrix4d world;          ///< takes positions of the accessor to those of the mesh that is read
};

/// Those of a file that read_gltf() reads. \throw InputError
std::vector<PrimitiveUse> primitive_uses(const std::filesystem::path& file, std::string_view content);

std::size_t component_size(std::int64_t type);  ///< bytes; 0 for an unknown type

/// A number of a buffer; normalised integers (KHR_mesh_quantization) stand for fractions.
double load_component(const char* bytes, std::int64_t type, bool normalised);

/// A GLB of a JSON text and its binary data. \param file  for messages \throw InputError where it had more than 4 GB
std::string glb_container(const std::filesystem::path& file, std::string json, std::string data);

std::optional<std::string> decode_base64(std::string_view text);
std::string decode_percent(std::string_view text);

}  // namespace orbifit::gltf

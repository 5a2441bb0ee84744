#include "files/draco.h"

#ifdef ORBIFIT_PORTABLE

namespace orbifit::gltf {

DracoMesh decode_draco(std::string_view /*bytes*/, std::span<const DracoRequest> /*requests*/) {
  throw DracoError("Draco is not read here: convert the file with the program");
}

}  // namespace orbifit::gltf

#else

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wold-style-cast"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wunused-parameter"
#include <draco/compression/decode.h>
#include <draco/core/varint_decoding.h>
#pragma GCC diagnostic pop

#include "files/gltf.h"
#include "files/mesh_builder.h"

namespace orbifit::gltf {

namespace {

// How many faces the header of a mesh announces, in the bitstream since version 2.2 without metadata, which is what
// writers of glTF make; 0 where it cannot be told.
std::uint32_t announced_faces(std::string_view bytes) {
  constexpr std::size_t kHeader = 11;  // bytes: "DRACO", version (2), kind, method, flags (2)
  constexpr char kEdgebreaker = 1;
  constexpr std::uint16_t kVersion = 0x0202;
  if (bytes.size() < kHeader) return 0;
  const auto byte = [&](std::size_t at) { return static_cast<std::uint8_t>(bytes[at]); };
  if ((byte(5) << 8U | byte(6)) < kVersion || byte(9) != 0 || byte(10) != 0) return 0;
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data() + kHeader, bytes.size() - kHeader, kVersion);
  std::uint32_t number = 0;
  if (bytes[8] == kEdgebreaker) {
    std::uint8_t traversal = 0;
    if (!buffer.Decode(&traversal) || !draco::DecodeVarint(&number, &buffer)) return 0;  // the vertices
  }
  return draco::DecodeVarint(&number, &buffer) ? number : 0;
}

template <class Number>
std::string rows(const draco::PointAttribute& attribute, std::uint32_t points, int components) {
  std::string bytes;
  bytes.reserve(points * static_cast<std::size_t>(components) * sizeof(Number));
  std::array<Number, 4> row{};
  for (draco::PointIndex point(0); point < points; ++point) {
    if (!attribute.ConvertValue<Number>(attribute.mapped_index(point), static_cast<std::int8_t>(components),
                                        row.data())) {
      throw DracoError("an attribute cannot be converted to the type of its accessor");
    }
    bytes.append(reinterpret_cast<const char*>(row.data()), static_cast<std::size_t>(components) * sizeof(Number));
  }
  return bytes;
}

std::string rows(const draco::Mesh& mesh, const DracoRequest& request) {
  const draco::PointAttribute* attribute = mesh.GetAttributeByUniqueId(static_cast<std::uint32_t>(request.id));
  if (attribute == nullptr) throw DracoError("there is no attribute " + std::to_string(request.id) + " in it");
  switch (request.type) {
    case kByte:
      return rows<std::int8_t>(*attribute, mesh.num_points(), request.components);
    case kUnsignedByte:
      return rows<std::uint8_t>(*attribute, mesh.num_points(), request.components);
    case kShort:
      return rows<std::int16_t>(*attribute, mesh.num_points(), request.components);
    case kUnsignedShort:
      return rows<std::uint16_t>(*attribute, mesh.num_points(), request.components);
    case kUnsignedInt:
      return rows<std::uint32_t>(*attribute, mesh.num_points(), request.components);
    default:
      return rows<float>(*attribute, mesh.num_points(), request.components);
  }
}

}  // namespace

DracoMesh decode_draco(std::string_view bytes, std::span<const DracoRequest> requests) {
  if (announced_faces(bytes) > kMostVertices) throw DracoError("too many faces are announced");
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data(), bytes.size());
  draco::Decoder decoder;
  auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
  if (!decoded.ok()) throw DracoError(decoded.status().error_msg_string());
  const draco::Mesh& mesh = *decoded.value();
  DracoMesh result;
  result.points = mesh.num_points();
  result.corners.reserve(3 * static_cast<std::size_t>(mesh.num_faces()));
  for (draco::FaceIndex f(0); f < mesh.num_faces(); ++f) {
    for (const draco::PointIndex& corner : mesh.face(f)) {
      if (corner.value() >= mesh.num_points()) throw DracoError("a corner names a point that there is not");
      result.corners.push_back(corner.value());
    }
  }
  for (const DracoRequest& request : requests) result.attributes.push_back(rows(mesh, request));
  return result;
}

}  // namespace orbifit::gltf

#endif

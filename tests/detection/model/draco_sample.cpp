#include "draco_sample.h"

#include <array>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wold-style-cast"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wunused-parameter"
#include <draco/compression/encode.h>
#pragma GCC diagnostic pop

namespace orbifit {

std::string draco_bytes(const Mesh& mesh, bool edgebreaker, int bits) {
  draco::Mesh packed;
  const auto count = static_cast<std::uint32_t>(mesh.vertices.rows());
  packed.set_num_points(count);
  const auto add = [&](draco::GeometryAttribute::Type type, int width, const auto& row_of) {
    draco::GeometryAttribute attribute;
    attribute.Init(type, nullptr, static_cast<std::uint8_t>(width), draco::DT_FLOAT32, false,
                   static_cast<std::int64_t>(sizeof(float)) * width, 0);
    const int id = packed.AddAttribute(attribute, true, count);
    for (std::uint32_t v = 0; v < count; ++v) {
      const std::array<float, 3> row = row_of(mesh.vertices.row(v));
      packed.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(v), row.data());
    }
  };
  using Row = Eigen::RowVector3d;
  const auto single = [](double x, double y, double z) {
    return std::array<float, 3>{static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
  };
  add(draco::GeometryAttribute::POSITION, 3, [&](const Row& p) { return single(p.x(), p.y(), p.z()); });
  add(draco::GeometryAttribute::NORMAL, 3, [&](const Row&) { return single(0, 0, 1); });
  add(draco::GeometryAttribute::TEX_COORD, 2, [&](const Row& p) { return single(p.x() / 4, p.y() / 4, 0); });
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    draco::Mesh::Face face;
    for (int k = 0; k < 3; ++k) face[static_cast<std::size_t>(k)] = static_cast<std::uint32_t>(mesh.faces(f, k));
    packed.AddFace(face);
  }
  draco::Encoder encoder;
  encoder.SetEncodingMethod(edgebreaker ? draco::MESH_EDGEBREAKER_ENCODING : draco::MESH_SEQUENTIAL_ENCODING);
  if (bits > 0) {
    encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, bits);
    encoder.SetAttributeQuantization(draco::GeometryAttribute::TEX_COORD, bits);
    encoder.SetAttributeQuantization(draco::GeometryAttribute::NORMAL, 8);
  }
  draco::EncoderBuffer buffer;
  if (!encoder.EncodeMeshToBuffer(packed, &buffer).ok()) return "";
  return {buffer.data(), buffer.size()};
}

GltfSample draco_sample(const Mesh& mesh, bool edgebreaker, int bits) {
  GltfSample sample;
  const auto add = [&](const char* name, const char* type) {
    sample.root["accessors"].push_back({{"componentType", 5126}, {"count", mesh.vertices.rows()}, {"type", type}});
    sample.attributes()[name] = sample.root["accessors"].size() - 1;
  };
  add("POSITION", "VEC3");
  add("NORMAL", "VEC3");
  add("TEXCOORD_0", "VEC2");
  sample.root["accessors"].push_back({{"componentType", 5123}, {"count", 3 * mesh.faces.rows()}, {"type", "SCALAR"}});
  sample.primitive()["indices"] = sample.root["accessors"].size() - 1;
  sample.primitive()["extensions"]["KHR_draco_mesh_compression"] = {
      {"bufferView", sample.view(draco_bytes(mesh, edgebreaker, bits))},
      {"attributes", {{"POSITION", 0}, {"NORMAL", 1}, {"TEXCOORD_0", 2}}}};
  sample.root["extensionsUsed"] = sample.root["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  return sample;
}

}  // namespace orbifit

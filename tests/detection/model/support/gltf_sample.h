#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

#include <nlohmann/json.hpp>

#include "orbifit/model/mesh.h"

#include "files/gltf.h"

namespace orbifit {

/// A GLB that a test puts together.
struct GltfSample {
  using Json = nlohmann::ordered_json;

  Json root = Json::parse(R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
      "meshes":[{"primitives":[{"attributes":{}}]}],"accessors":[],"bufferViews":[],"buffers":[{"byteLength":0}]})");
  std::string data;

  int view(const std::string& bytes) {
    data.resize((data.size() + 3) / 4 * 4, '\0');
    root["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", data.size()}, {"byteLength", bytes.size()}});
    data += bytes;
    return static_cast<int>(root["bufferViews"].size()) - 1;
  }

  template <class Number>
  static std::string bytes(const std::vector<Number>& numbers) {
    return {reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(Number)};
  }

  template <class Number>
  static constexpr int component() {
    if constexpr (std::is_same_v<Number, std::int8_t>) return gltf::kByte;
    if constexpr (std::is_same_v<Number, std::uint8_t>) return gltf::kUnsignedByte;
    if constexpr (std::is_same_v<Number, std::int16_t>) return gltf::kShort;
    if constexpr (std::is_same_v<Number, std::uint16_t>) return gltf::kUnsignedShort;
    if constexpr (std::is_same_v<Number, std::uint32_t>) return gltf::kUnsignedInt;
    return gltf::kFloat;
  }

  /// \param type  SCALAR, VEC2, VEC3 or VEC4
  template <class Number>
  int accessor(const std::vector<Number>& numbers, const std::string& type, bool normalised = false) {
    const std::size_t width = type == "SCALAR" ? 1 : static_cast<std::size_t>(type.back() - '0');
    Json entry{{"bufferView", view(bytes(numbers))},
               {"componentType", component<Number>()},
               {"count", numbers.size() / width},
               {"type", type}};
    if (normalised) entry["normalized"] = true;
    root["accessors"].push_back(entry);
    return static_cast<int>(root["accessors"].size()) - 1;
  }

  Json& primitive() { return root["meshes"][0]["primitives"][0]; }
  Json& attributes() { return primitive()["attributes"]; }

  std::string glb() {
    root["buffers"][0]["byteLength"] = data.size();
    return gltf::glb_container("sample", root.dump(), data);
  }
};

inline std::vector<float> floats(const Points& points) {
  std::vector<float> result;
  for (const double number : points.reshaped<Eigen::RowMajor>()) result.push_back(static_cast<float>(number));
  return result;
}

/// A mesh with a normal and texture coordinates at each vertex.
inline GltfSample gltf_of(const Mesh& mesh) {
  GltfSample sample;
  const auto count = static_cast<std::size_t>(mesh.vertices.rows());
  sample.attributes()["POSITION"] = sample.accessor(floats(mesh.vertices), "VEC3");
  std::vector<float> normals(3 * count, 0);
  for (std::size_t v = 0; v < count; ++v) normals[3 * v + 2] = 1;
  sample.attributes()["NORMAL"] = sample.accessor(normals, "VEC3");
  sample.attributes()["TEXCOORD_0"] = sample.accessor(std::vector<float>(2 * count, 0.5F), "VEC2");
  std::vector<std::uint16_t> corners;
  for (const int corner : mesh.faces.reshaped<Eigen::RowMajor>()) corners.push_back(static_cast<std::uint16_t>(corner));
  sample.primitive()["indices"] = sample.accessor(corners, "SCALAR");
  return sample;
}

}  // namespace orbifit

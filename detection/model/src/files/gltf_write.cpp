#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "orbifit/model/errors.h"

#include "files/binary.h"
#include "files/gltf.h"
#include "files/mesh_formats.h"

namespace orbifit {

using namespace gltf;

std::string gltf::glb_container(const std::filesystem::path& file, std::string json, std::string data) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  data.resize((data.size() + 3) / 4 * 4, '\0');
  const std::size_t total = 12 + 8 + json.size() + 8 + data.size();
  if (total > 0xFFFFFFFFU) throw InputError(file.string(), "", "cannot hold a mesh of more than 4 GB");
  std::string bytes;
  bytes.reserve(total);
  store(bytes, kMagic);
  store(bytes, std::uint32_t{2});
  store(bytes, static_cast<std::uint32_t>(total));
  store(bytes, static_cast<std::uint32_t>(json.size()));
  store(bytes, kJsonChunk);
  bytes += json;
  store(bytes, static_cast<std::uint32_t>(data.size()));
  store(bytes, kBinChunk);
  bytes += data;
  return bytes;
}

std::string glb_bytes(const std::filesystem::path& file, const Mesh& mesh) {
  std::string data;
  const std::size_t position_bytes = 12 * static_cast<std::size_t>(mesh.vertices.rows());
  const std::size_t index_bytes = 12 * static_cast<std::size_t>(mesh.faces.rows());
  data.reserve(position_bytes + index_bytes);
  for (const double coordinate : mesh.vertices.reshaped<Eigen::RowMajor>()) store(data, to_float(file, coordinate));
  for (const int corner : mesh.faces.reshaped<Eigen::RowMajor>()) store(data, static_cast<std::uint32_t>(corner));

  std::vector<float> low(3);
  std::vector<float> high(3);
  for (int k = 0; k < 3; ++k) {
    low[static_cast<std::size_t>(k)] = static_cast<float>(mesh.vertices.col(k).minCoeff());
    high[static_cast<std::size_t>(k)] = static_cast<float>(mesh.vertices.col(k).maxCoeff());
  }
  nlohmann::ordered_json root;
  root["asset"] = {{"version", "2.0"}, {"generator", "Orbifit"}};
  root["scene"] = 0;
  root["scenes"] = {{{"nodes", {0}}}};
  root["nodes"] = {{{"mesh", 0}}};
  root["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"indices", 1}}}}}};
  root["accessors"] = {
      {{"bufferView", 0},
       {"componentType", int{kFloat}},
       {"count", mesh.vertices.rows()},
       {"type", "VEC3"},
       {"min", low},
       {"max", high}},
      {{"bufferView", 1}, {"componentType", int{kUnsignedInt}}, {"count", 3 * mesh.faces.rows()}, {"type", "SCALAR"}}};
  root["bufferViews"] = {
      {{"buffer", 0}, {"byteOffset", 0}, {"byteLength", position_bytes}, {"target", 34962}},
      {{"buffer", 0}, {"byteOffset", position_bytes}, {"byteLength", index_bytes}, {"target", 34963}}};
  root["buffers"] = {{{"byteLength", data.size()}}};
  return glb_container(file, root.dump(), std::move(data));
}

}  // namespace orbifit

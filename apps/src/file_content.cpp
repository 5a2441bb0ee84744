#include "file_content.h"

#include <algorithm>
#include <set>

#include "orbifit/model/appearance.h"
#include "orbifit/model/errors.h"

#include "files/file.h"
#include "files/gltf_file.h"
#include "files/three_mf.h"

namespace orbifit {

namespace {

using Json = nlohmann::ordered_json;

// What glTF has and an Appearance has not.
void add_gltf(const std::string& file, Json& content) {
  const std::string bytes = read_file(file);
  GltfFile gltf(file, bytes);
  const Json& root = gltf.root();
  const auto count = [&](const char* key) { return root.contains(key) && root[key].is_array() ? root[key].size() : 0; };
  int sets = 0;
  if (count("meshes") > 0) {
    for (const Json& mesh : root["meshes"]) {
      for (const Json& primitive : mesh.value("primitives", Json::array())) {
        int own = 0;
        const Json attributes = primitive.value("attributes", Json::object());
        while (attributes.contains("TEXCOORD_" + std::to_string(own))) ++own;
        sets = std::max(sets, own);
      }
    }
  }
  content["uv_sets"] = sets;
  for (const char* key : {"nodes", "meshes", "skins", "animations"}) content[key] = count(key);
  content["extensions"] = root.value("extensionsUsed", Json::array());
  content["unit"] = "metre";
}

// What 3MF has and an Appearance has not.
void add_three_mf(const std::string& file, Json& content) {
  MeshBuilder builder(file);
  const ThreeMfContent told = read_three_mf_content(file, read_file(file), builder);
  content["unit"] = told.unit;
  content["build_items"] = told.items;
  content["parts"] = told.parts.size();
  std::set<std::int64_t> meshes;
  for (const ThreeMfPart& part : told.parts) meshes.insert(part.object);
  content["meshes"] = meshes.size();
}

// Names of parts, each once, in the file's order.
Json names(const Appearance& look, std::string Part::*of) {
  Json result = Json::array();
  std::set<std::string> known;
  for (const Part& part : look.parts) {
    if (!(part.*of).empty() && known.insert(part.*of).second) result.push_back(part.*of);
  }
  return result;
}

}  // namespace

Json file_content(const std::string& file, const Mesh& mesh) {
  const std::string ending = lower_extension(file);
  Json content{{"format", ending.empty() ? "" : ending.substr(1)}};
  try {
    const Appearance look = read_appearance(file, mesh);
    content["uv_sets"] = look.uvs.rows() > 0 ? 1 : 0;
    content["normals"] = look.normals.rows() > 0;
    content["colours"] = look.colours.rows() > 0;
    content["materials"] = Json::array();
    for (const Material& material : look.materials) {
      Json entry{{"name", material.name}, {"base_colour", material.base_colour}};
      if (!material.texture.empty() || !material.image.empty()) {
        entry["texture"] = material.texture;
        entry["texture_found"] = !material.image.empty();
      }
      content["materials"].push_back(entry);
    }
    content["objects"] = names(look, &Part::object);
    content["groups"] = names(look, &Part::group);
    content["warnings"] = look.warnings;
    content["unit"] = nullptr;
    if (ending == ".gltf" || ending == ".glb") add_gltf(file, content);
    if (ending == ".3mf") add_three_mf(file, content);
  } catch (const InputError& error) {
    content["problem"] = error.what();
  }
  return content;
}

}  // namespace orbifit

#include "files/gltf_plain.h"

#include <algorithm>
#include <array>
#include <set>

#include "files/binary.h"
#include "files/draco.h"
#include "files/gltf.h"
#include "files/gltf_document.h"
#include "files/gltf_file.h"

namespace orbifit::gltf {

namespace fs = std::filesystem;

namespace {

using Json = GltfFile::Json;

constexpr const char* kDraco = "KHR_draco_mesh_compression";
constexpr const char* kInstancing = "EXT_mesh_gpu_instancing";
// A node takes some 1 KB of memory while it is read: this is 1 GB.
constexpr std::int64_t kMaxInstances = 1'000'000;

// Whether a word of these stands in the file's JSON text.
bool may_need_it(std::string_view content) {
  constexpr std::size_t kBegin = 20;  // of a GLB's text, behind its header and that of its first chunk
  if (content.size() >= kBegin && load<std::uint32_t>(content.data()) == kMagic) {
    content = content.substr(0, kBegin + load<std::uint32_t>(content.data() + 12));
  }
  return std::ranges::any_of(std::array{"\"sparse\"", kDraco, kInstancing},
                             [&](const char* word) { return content.find(word) != std::string_view::npos; });
}

// A copy of the file while it is made plain. What it says is asked of the document, which checks it.
class PlainFile {
 public:
  PlainFile(const fs::path& file, std::string_view content) : document_(file, content), file_(file, content) {}

  std::string write() {
    const Document::Json* meshes = document_.list("meshes");
    for (std::size_t m = 0; meshes != nullptr && m < meshes->size(); ++m) {
      const Document::Json* primitives = Document::find((*meshes)[m], "primitives");
      if (primitives == nullptr || !primitives->is_array()) continue;
      for (std::size_t p = 0; p < primitives->size(); ++p) make_plain((*primitives)[p], m, p);
    }
    const Document::Json* nodes = document_.list("nodes");
    for (std::size_t n = 0; nodes != nullptr && n < nodes->size(); ++n) make_nodes((*nodes)[n], n);
    for (const char* list : {"extensionsUsed", "extensionsRequired"}) forget_extensions(list);
    return file_.bytes();
  }

 private:
  void make_plain(const Document::Json& primitive, std::size_t m, std::size_t p) {
    const std::string where = "meshes[" + std::to_string(m) + "].primitives[" + std::to_string(p) + "]";
    if (const auto* attributes = Document::find(primitive, "attributes"); attributes != nullptr) {
      for (const auto& [name, number] : attributes->items()) fill(*attributes, name.c_str(), where + ".attributes");
    }
    fill(primitive, "indices", where);
    const Document::Json* extensions = Document::find(primitive, "extensions");
    const Document::Json* draco = extensions == nullptr ? nullptr : Document::find(*extensions, kDraco);
    if (draco != nullptr) decode(*draco, primitive, file_.root()["meshes"][m]["primitives"][p], where);
  }

  // Gives a sparse accessor all its numbers.
  void fill(const Document::Json& object, const char* key, const std::string& where) {
    const std::int64_t number = document_.integer(object, key, -1, where);
    if (number < 0 || !filled_.insert(number).second) return;
    if (Document::find(document_.item("accessors", number, where), "sparse") == nullptr) return;
    const bool indices = std::string_view(key) == "indices";
    const Document::Rows rows = document_.filled(number, indices ? 1 : 4);  // bytes from row to row: as glTF asks for
    const std::int64_t view = file_.add_view(rows.bytes);
    if (!indices) file_.root()["bufferViews"][index(view)]["byteStride"] = rows.stride;
    Json& accessor = file_.root()["accessors"][index(number)];
    accessor["bufferView"] = view;
    accessor.erase("byteOffset");
    accessor.erase("sparse");
  }

  void decode(const Document::Json& draco, const Document::Json& primitive, Json& target, const std::string& where) {
    const std::string at = where + ".extensions." + kDraco;
    const Document::Json* ids = Document::find(draco, "attributes");
    const Document::Json* attributes = Document::find(primitive, "attributes");
    if (ids == nullptr || !ids->is_object() || attributes == nullptr) document_.refuse(at, "names no attributes");
    std::vector<DracoRequest> requests;
    std::vector<std::string> names;
    for (const auto& [name, id] : ids->items()) {
      const std::int64_t number = document_.integer(*attributes, name.c_str(), -1, where + ".attributes");
      if (number < 0) continue;  // in the compressed data, but none of the primitive's
      const auto& accessor = document_.item("accessors", number, where + ".attributes." + name);
      const std::string of = "accessors[" + std::to_string(number) + "]";
      const std::int64_t type = document_.integer(accessor, "componentType", -1, of);
      if (component_size(type) == 0)
        document_.refuse(of + ".componentType", "is " + std::to_string(type) + ": unknown");
      const int components = document_.components(accessor, of);
      requests.push_back({document_.integer(*ids, name.c_str(), -1, at + ".attributes"), type, components});
      names.push_back(name);
    }
    DracoMesh mesh;
    try {
      mesh = decode_draco(document_.view(document_.integer(draco, "bufferView", -1, at), at), requests);
    } catch (const DracoError& error) {
      document_.refuse(at, std::string("cannot be decoded: ") + error.what());
    }
    for (std::size_t k = 0; k < names.size(); ++k) {
      target["attributes"][names[k]] = add_attribute(target["attributes"][names[k]], requests[k], mesh, k);
    }
    std::string corners;
    for (const std::uint32_t corner : mesh.corners) store(corners, corner);
    const std::int64_t view = file_.add_view(corners);
    target["indices"] = file_.root()["accessors"].size();
    file_.root()["accessors"].push_back({{"bufferView", view},
                                         {"componentType", int{kUnsignedInt}},
                                         {"count", mesh.corners.size()},
                                         {"type", "SCALAR"}});
    target.erase("mode");  // Draco gives triangles
    forget(target, kDraco);
  }

  // The accessor that a primitive names gets the numbers; a copy of it, where another primitive has had it.
  std::size_t add_attribute(const Json& number, const DracoRequest& request, const DracoMesh& mesh, std::size_t k) {
    const std::size_t size = component_size(request.type) * static_cast<std::size_t>(request.components);
    const std::size_t stride = (size + 3) / 4 * 4;  // as glTF asks for
    std::string rows;
    rows.reserve(static_cast<std::size_t>(mesh.points) * stride);
    for (std::size_t at = 0; at < mesh.attributes[k].size(); at += size) {
      rows.append(mesh.attributes[k], at, size).resize((rows.size() + 3) / 4 * 4, '\0');
    }
    const std::int64_t view = file_.add_view(rows);
    file_.root()["bufferViews"][index(view)]["byteStride"] = stride;
    auto result = number.get<std::size_t>();
    Json accessor = file_.root()["accessors"][result];
    accessor["bufferView"] = view;
    accessor["count"] = mesh.points;
    accessor.erase("byteOffset");
    set_bounds(accessor, request, mesh.attributes[k]);
    if (decoded_.insert(result).second) {
      file_.root()["accessors"][result] = accessor;
    } else {
      result = file_.root()["accessors"].size();
      file_.root()["accessors"].push_back(accessor);
    }
    return result;
  }

  // Where they are stated: what has been quantised is not quite within those of before.
  static void set_bounds(Json& accessor, const DracoRequest& request, const std::string& numbers) {
    const std::size_t size = component_size(request.type);
    const auto components = static_cast<std::size_t>(request.components);
    for (const char* key : {"min", "max"}) {
      if (!accessor.contains(key) || numbers.empty()) continue;
      Json bounds = Json::array();
      for (std::size_t c = 0; c < components; ++c) {
        double bound = load_component(numbers.data() + c * size, request.type, false);
        for (std::size_t at = c * size; at < numbers.size(); at += components * size) {
          const double number = load_component(numbers.data() + at, request.type, false);
          bound = std::string_view(key) == "min" ? std::min(bound, number) : std::max(bound, number);
        }
        bounds.push_back(request.type == kFloat ? Json(bound) : Json(static_cast<std::int64_t>(bound)));
      }
      accessor[key] = bounds;
    }
  }

  void make_nodes(const Document::Json& node, std::size_t n) {
    const std::string where = "nodes[" + std::to_string(n) + "].extensions." + kInstancing;
    const Document::Json* extensions = Document::find(node, "extensions");
    const Document::Json* instancing = extensions == nullptr ? nullptr : Document::find(*extensions, kInstancing);
    if (instancing == nullptr) return;
    const Document::Json* attributes = Document::find(*instancing, "attributes");
    if (attributes == nullptr || !attributes->is_object()) document_.refuse(where, "names no attributes");
    std::int64_t count = -1;
    std::array<std::optional<Accessor>, 3> columns;
    constexpr std::array<const char*, 3> kNames{"TRANSLATION", "ROTATION", "SCALE"};
    constexpr std::array<const char*, 3> kKeys{"translation", "rotation", "scale"};
    for (std::size_t k = 0; k < kNames.size(); ++k) {
      const std::int64_t number = document_.integer(*attributes, kNames[k], -1, where + ".attributes");
      if (number < 0) continue;
      columns[k] = document_.accessor(number, k == 1 ? 4 : 3, kKeys[k]);
      if (count >= 0 && columns[k]->count != count) {
        document_.refuse(where + ".attributes", "has accessors of " + std::to_string(count) + " and of " +
                                                    std::to_string(columns[k]->count) + " entries");
      }
      count = columns[k]->count;
    }
    if (count < 0) document_.refuse(where + ".attributes", "has no TRANSLATION, ROTATION or SCALE");
    instances_ += count;
    if (instances_ > kMaxInstances) document_.refuse(where, "the file has more than a million instances");

    Json& nodes = file_.root()["nodes"];
    Json instance = Json::object();
    for (const char* key : {"name", "mesh", "skin", "weights"}) {
      if (nodes[n].contains(key)) instance[key] = nodes[n][key];
      if (std::string_view(key) != "name") nodes[n].erase(key);
    }
    Json children = Json::array();
    for (std::int64_t i = 0; i < count && instance.contains("mesh"); ++i) {
      for (std::size_t k = 0; k < kKeys.size(); ++k) {
        if (columns[k]) instance[kKeys[k]] = row(*columns[k], i, k == 1);
      }
      children.push_back(nodes.size());
      nodes.push_back(instance);
    }
    if (const auto* old = Document::find(node, "children"); old != nullptr && old->is_array()) {
      for (const Document::Json& child : *old) children.push_back(Json(child));
    }
    if (children.empty()) {
      nodes[n].erase("children");
    } else {
      nodes[n]["children"] = children;
    }
    forget(nodes[n], kInstancing);
  }

  // Normalised integers make a rotation that is a unit only nearly.
  std::vector<double> row(const Accessor& column, std::int64_t number, bool rotation) const {
    std::vector<double> values;
    for (std::size_t k = 0; k < column.components; ++k) values.push_back(column.value(number, k));
    if (!std::ranges::all_of(values, [](double value) { return std::isfinite(value); })) {
      document_.refuse(kInstancing, "instance " + std::to_string(number) + " is placed by numbers that are not finite");
    }
    Eigen::Map<Eigen::VectorXd> vector(values.data(), static_cast<Eigen::Index>(values.size()));
    if (rotation && vector.norm() > 0) vector.normalize();
    return values;
  }

  static void forget(Json& object, const char* extension) {
    object["extensions"].erase(extension);
    if (object["extensions"].empty()) object.erase("extensions");
  }

  void forget_extensions(const char* key) {
    Json& root = file_.root();
    if (!root.contains(key) || !root[key].is_array()) return;
    Json kept = Json::array();
    for (const Json& name : root[key]) {
      if (name != kDraco && name != kInstancing) kept.push_back(name);
    }
    if (kept.empty()) {
      root.erase(key);
    } else {
      root[key] = kept;
    }
  }

  static std::size_t index(std::int64_t number) { return static_cast<std::size_t>(number); }

  Document document_;
  GltfFile file_;
  std::set<std::int64_t> filled_;  // accessors that have been looked at
  std::set<std::size_t> decoded_;  // accessors that have got numbers of Draco's
  std::int64_t instances_ = 0;
};

}  // namespace

Plain plain(const fs::path& file, std::string_view content) {
  if (!may_need_it(content)) return {};
  return {PlainFile(file, content).write()};
}

}  // namespace orbifit::gltf

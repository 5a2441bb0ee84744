#include <algorithm>
#include <limits>
#include <map>
#include <optional>

#include <Eigen/LU>

#include "orbifit/model/errors.h"

#include "files/file.h"
#include "files/gltf.h"
#include "files/text.h"
#include "look/look_formats.h"
#include "rewrite/gltf_file.h"

namespace orbifit {

namespace fs = std::filesystem;

namespace {

using Json = GltfFile::Json;
using Eigen::Index;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

class GltfLookReader {
 public:
  GltfLookReader(const fs::path& file, std::string_view content, const Mesh& mesh)
      : file_(file), mesh_(mesh), gltf_(file, content), uses_(gltf::primitive_uses(file, content)) {}

  Appearance read() {
    for (std::size_t u = 0; u < uses_.size(); ++u) {
      const std::int64_t end = u + 1 < uses_.size() ? uses_[u + 1].first_vertex : mesh_.vertices.rows();
      while (face_ < mesh_.faces.rows() && mesh_.faces(face_, 0) < end) ++face_;
      read_use(uses_[u], end - uses_[u].first_vertex);
      first_face_ = face_;
    }
    if (look_.materials.empty()) look_.material_of_face.clear();
    return std::move(look_);
  }

 private:
  [[noreturn]] void refuse(const std::string& where, const std::string& reason) const {
    throw InputError(file_.string(), where, reason);
  }

  static const Json* find(const Json& object, const char* key) {
    if (!object.is_object()) return nullptr;
    const auto found = object.find(key);
    return found == object.end() ? nullptr : &*found;
  }

  // An entry of a list at the top level. \throw InputError where it is none
  const Json& entry(const char* list, const Json& number, const std::string& user) {
    const Json* all = find(gltf_.root(), list);
    const std::size_t size = all != nullptr && all->is_array() ? all->size() : 0;
    if (!number.is_number_integer() || number.get<double>() < 0 || number.get<double>() >= static_cast<double>(size)) {
      refuse(user, "names an entry of " + std::string(list) + " that there is not");
    }
    const Json& result = (*all)[number.get<std::size_t>()];
    if (!result.is_object()) refuse(std::string(list) + "[" + number.dump() + "]", "must be an object");
    return result;
  }

  static bool whole(const Json& object, const char* key, bool needed) {
    const Json* found = find(object, key);
    return found == nullptr ? !needed
                            : found->is_number_integer() && found->get<double>() >= 0 && found->get<double>() < 9e15;
  }

  // The rows of an attribute, or nothing where the primitive has none.
  std::optional<GltfAttribute> attribute(const Json& primitive, const char* name, std::int64_t count,
                                         const std::string& where) {
    const Json* attributes = find(primitive, "attributes");
    const Json* number = attributes != nullptr ? find(*attributes, name) : nullptr;
    if (number == nullptr) return std::nullopt;
    const Json& accessor = entry("accessors", *number, where + "." + name);
    const std::string at = "accessors[" + number->dump() + "]";
    const Json* type = find(accessor, "type");
    if (type == nullptr || (*type != "VEC2" && *type != "VEC3" && *type != "VEC4")) refuse(at, "is no list of vectors");
    if (find(accessor, "sparse") != nullptr || find(accessor, "bufferView") == nullptr) {
      refuse(at, "sparse accessors are not read");
    }
    const bool good = whole(accessor, "bufferView", true) && whole(accessor, "count", true) &&
                      whole(accessor, "byteOffset", false) && whole(accessor, "componentType", true) &&
                      gltf::component_size(accessor["componentType"].get<std::int64_t>()) > 0;
    if (!good) refuse(at, "has a key that is no integer, or a component type that there is not");
    if (accessor["count"].get<std::int64_t>() != count) {
      refuse(at, "has " + accessor["count"].dump() + " rows for " + std::to_string(count) + " vertices");
    }
    const Json& view = entry("bufferViews", accessor["bufferView"], at);
    if (!whole(view, "byteStride", false) || !whole(view, "byteOffset", false) || !whole(view, "buffer", true)) {
      refuse(at, "is in a buffer view with a key that is no integer");
    }
    gltf_.view(accessor["bufferView"].get<std::int64_t>());
    return gltf_.attribute(number->get<std::int64_t>());
  }

  template <class Rows>
  static void fill(Rows& rows, Index columns, Index corners, double with) {
    if (rows.rows() == 0) rows = Rows::Constant(corners, columns, with);
  }

  void read_use(const gltf::PrimitiveUse& use, std::int64_t count) {
    const std::string where =
        "meshes[" + std::to_string(use.mesh) + "].primitives[" + std::to_string(use.primitive) + "]";
    const Json& primitive = gltf_.root()["meshes"][static_cast<std::size_t>(use.mesh)]["primitives"]
                                        [static_cast<std::size_t>(use.primitive)];
    const Index corners = 3 * mesh_.faces.rows();
    const auto uvs = attribute(primitive, "TEXCOORD_0", count, where);
    const auto normals = attribute(primitive, "NORMAL", count, where);
    const auto colours = attribute(primitive, "COLOR_0", count, where);
    if (uvs) fill(look_.uvs, 2, corners, kNone);
    if (normals) fill(look_.normals, 3, corners, kNone);
    if (colours) fill(look_.colours, 4, corners, 1);
    const Eigen::Matrix3d turn = use.world.topLeftCorner<3, 3>().inverse().transpose();
    for (Index f = first_face_; f < face_; ++f) {
      for (int k = 0; k < 3; ++k) {
        const auto row = static_cast<std::size_t>(mesh_.faces(f, k) - use.first_vertex);
        const auto value = [&](const GltfAttribute& from, int c) -> double {
          return from.values[row * static_cast<std::size_t>(from.components) + static_cast<std::size_t>(c)];
        };
        const Index corner = 3 * f + k;
        if (uvs) look_.uvs.row(corner) << value(*uvs, 0), 1 - value(*uvs, 1);
        if (normals && normals->components >= 3) {
          const Eigen::Vector3d normal(value(*normals, 0), value(*normals, 1), value(*normals, 2));
          look_.normals.row(corner) = (turn * normal).normalized().transpose();
        }
        for (int c = 0; colours && c < colours->components; ++c) {
          look_.colours(corner, c) = std::clamp(value(*colours, c), 0.0, 1.0);
        }
      }
    }
    const Json* number = find(primitive, "material");
    look_.material_of_face.resize(static_cast<std::size_t>(face_), number == nullptr ? -1 : material(*number, where));
  }

  int material(const Json& number, const std::string& where) {
    const Json& entry_of = entry("materials", number, where);
    const auto [known, added] =
        materials_.try_emplace(number.get<std::int64_t>(), static_cast<int>(look_.materials.size()));
    if (!added) return known->second;
    Material result;
    const Json* name = find(entry_of, "name");
    result.name = name != nullptr && name->is_string() ? name->get<std::string>() : "material-" + number.dump();
    if (const Json* surface = find(entry_of, "pbrMetallicRoughness")) {
      const Json* colour = find(*surface, "baseColorFactor");
      for (std::size_t k = 0; colour != nullptr && colour->is_array() && k < std::min<std::size_t>(4, colour->size());
           ++k) {
        if ((*colour)[k].is_number()) result.base_colour[k] = (*colour)[k].get<double>();
      }
      const Json* texture = find(*surface, "baseColorTexture");
      if (texture != nullptr && find(*texture, "index") != nullptr) read_texture((*texture)["index"], result);
    }
    look_.materials.push_back(std::move(result));
    return known->second;
  }

  void read_texture(const Json& number, Material& material) {
    const Json* source = find(entry("textures", number, "materials"), "source");
    if (source == nullptr) return;
    const Json& image = entry("images", *source, "textures[" + number.dump() + "]");
    const Json* uri = find(image, "uri");
    if (const Json* view = find(image, "bufferView")) {
      const Json* name = find(image, "name");
      if (!view->is_number_integer()) refuse("images[" + source->dump() + "].bufferView", "must be an integer");
      material.image = gltf_.view(view->get<std::int64_t>());
      if (name != nullptr && name->is_string()) material.texture = file_name(name->get<std::string>(), material.image);
    } else if (uri != nullptr && uri->is_string()) {
      const auto& text = uri->get_ref<const std::string&>();
      const std::size_t data = text.find(";base64,");
      if (text.starts_with("data:") && data != std::string::npos) {
        material.image = gltf::decode_base64(std::string_view(text).substr(data + 8)).value_or("");
      } else {
        material.texture = gltf::decode_percent(text);
        read_image(file_.parent_path(), material, look_.warnings);
      }
    }
  }

  // An image's name as that of a file; "" where it would be none.
  static std::string file_name(const std::string& name, std::string_view bytes) {
    if (!within_folder(name) || name.find_first_of("/\\:") != std::string::npos) return "";
    const std::string ending = image_type(bytes) == "image/jpeg" ? ".jpg" : ".png";
    const std::string own = lower_extension(name);
    return own == ".png" || own == ".jpg" || own == ".jpeg" ? name : name + ending;
  }

  const fs::path& file_;
  const Mesh& mesh_;
  GltfFile gltf_;
  std::vector<gltf::PrimitiveUse> uses_;
  Appearance look_;
  std::map<std::int64_t, int> materials_;
  Index first_face_ = 0, face_ = 0;
};

}  // namespace

Appearance gltf_look(const fs::path& file, std::string_view content, const Mesh& mesh) {
  return GltfLookReader(file, content, mesh).read();
}

}  // namespace orbifit

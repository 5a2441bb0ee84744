#include <algorithm>
#include <limits>
#include <map>
#include <optional>

#include <Eigen/LU>

#include "orbifit/model/errors.h"

#include "files/file.h"
#include "files/gltf.h"
#include "files/gltf_file.h"
#include "files/gltf_plain.h"
#include "files/text.h"
#include "look/look_formats.h"

namespace orbifit {

namespace fs = std::filesystem;

namespace {

using Json = GltfFile::Json;
using Eigen::Index;

class GltfLookReader {
 public:
  GltfLookReader(const fs::path& file, std::string_view content, const Mesh& mesh)
      : file_(file),
        mesh_(mesh),
        plain_(gltf::plain(file, content)),
        gltf_(file, plain_.text(content)),
        uses_(gltf::primitive_uses(file, content)) {}

  Appearance read() {
    for (std::size_t u = 0; u < uses_.size(); ++u) {
      const std::int64_t end = u + 1 < uses_.size() ? uses_[u + 1].first_vertex : mesh_.vertices.rows();
      while (face_ < mesh_.faces.rows() && mesh_.faces(face_, 0) < end) ++face_;
      read_use(uses_[u], end - uses_[u].first_vertex);
      first_face_ = face_;
    }
    if (look_.materials.empty()) look_.material_of_face.clear();
    const bool named =
        std::ranges::any_of(look_.parts, [](const Part& p) { return !p.object.empty() || !p.group.empty(); });
    if (!named) {
      look_.part_of_face.clear();
      look_.parts.clear();
    }
    return std::move(look_);
  }

 private:
  [[noreturn]] void refuse(const std::string& where, const std::string& reason) const {
    throw InputError(file_.string(), where, reason);
  }

  static const Json* find(const Json& object, const char* key) { return GltfFile::find(object, key); }

  // The rows of an attribute, or nothing where the primitive has none. \throw InputError where they are no vectors of
  // `least` to `most` components
  std::optional<GltfAttribute> attribute(const Json& primitive, const char* name, int least, int most,
                                         std::int64_t count, const std::string& where) {
    const Json* attributes = find(primitive, "attributes");
    const Json* number = attributes != nullptr ? find(*attributes, name) : nullptr;
    if (number == nullptr) return std::nullopt;
    GltfAttribute result = gltf_.attribute(*number, count, where + "." + name);
    if (result.components < least || result.components > most) {
      refuse("accessors[" + number->dump() + "].type",
             "is VEC" + std::to_string(result.components) + ", which " + name + " cannot be");
    }
    return result;
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
    const auto uvs = attribute(primitive, "TEXCOORD_0", 2, 2, count, where);
    const auto normals = attribute(primitive, "NORMAL", 3, 3, count, where);
    const auto colours = attribute(primitive, "COLOR_0", 3, 4, count, where);
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
        if (normals) {
          const Eigen::Vector3d normal(value(*normals, 0), value(*normals, 1), value(*normals, 2));
          look_.normals.row(corner) = (turn * normal).normalized().transpose();
        }
        for (int c = 0; colours && c < colours->components; ++c) {
          look_.colours(corner, c) = std::clamp(value(*colours, c), 0.0, 1.0);
        }
      }
    }
    look_.part_of_face.resize(static_cast<std::size_t>(face_), part(use));
    const Json* number = find(primitive, "material");
    look_.material_of_face.resize(static_cast<std::size_t>(face_), number == nullptr ? -1 : material(*number, where));
  }

  // Primitives of one node are one part, which has the node's and the mesh's names.
  int part(const gltf::PrimitiveUse& use) {
    if (look_.parts.empty() || use.node != node_) {
      const auto name_of = [&](const char* list, std::int64_t number) -> std::string {
        const Json* name = find(gltf_.root()[list][static_cast<std::size_t>(number)], "name");
        return name != nullptr && name->is_string() ? name->get<std::string>() : "";
      };
      look_.parts.push_back({name_of("nodes", use.node), name_of("meshes", use.mesh)});
      node_ = use.node;
    }
    return static_cast<int>(look_.parts.size()) - 1;
  }

  int material(const Json& number, const std::string& where) {
    const Json& entry_of = gltf_.entry("materials", number, where);
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
    const Json* source = find(gltf_.entry("textures", number, "materials"), "source");
    if (source == nullptr) return;
    const Json& image = gltf_.entry("images", *source, "textures[" + number.dump() + "]");
    const Json* uri = find(image, "uri");
    if (const Json* view = find(image, "bufferView")) {
      const Json* name = find(image, "name");
      material.image = gltf_.view(*view, "images[" + source->dump() + "].bufferView");
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
  gltf::Plain plain_;
  GltfFile gltf_;
  std::vector<gltf::PrimitiveUse> uses_;
  Appearance look_;
  std::map<std::int64_t, int> materials_;
  Index first_face_ = 0, face_ = 0;
  std::int64_t node_ = -1;  // of the last part
};

}  // namespace

Appearance gltf_look(const fs::path& file, std::string_view content, const Mesh& mesh) {
  return GltfLookReader(file, content, mesh).read();
}

}  // namespace orbifit

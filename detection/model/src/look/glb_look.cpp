#include <cctype>
#include <cmath>
#include <cstdint>
#include <map>

#include <nlohmann/json.hpp>

#include "files/binary.h"
#include "files/gltf.h"
#include "files/mesh_formats.h"
#include "look/look_formats.h"

namespace orbifit {

namespace {

using Json = nlohmann::ordered_json;
using Eigen::Index;

// A file's name as a relative URI (RFC 3986).
std::string as_uri(const std::string& name) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::string uri;
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    const bool plain = std::isalnum(byte) != 0 || std::string_view("-._~/").find(c) != std::string_view::npos;
    if (plain) {
      uri += c;
    } else {
      uri += {'%', kDigits[byte >> 4U], kDigits[byte & 15U]};
    }
  }
  return uri;
}

// A GLB while it is put together.
class GlbWriter {
 public:
  GlbWriter(const std::filesystem::path& file, const Mesh& mesh, const Appearance& look)
      : file_(file), mesh_(mesh), look_(look) {
    root_["asset"] = {{"version", "2.0"}, {"generator", "Orbifit"}};
    root_["scene"] = 0;
    root_["scenes"] = {{{"nodes", Json::array()}}};
    root_["nodes"] = Json::array();
    root_["meshes"] = Json::array();
  }

  std::string write(std::vector<std::string>& problems) {
    std::vector<Run> runs = runs_of_faces();
    if (runs.size() > kMaxPrimitives) {
      problems.push_back(file_.string() + " has its faces sorted by parts and materials: these change " +
                         std::to_string(runs.size()) + " times");
      runs = joined(runs);
    }
    const bool alone = runs.size() == 1;
    for (std::size_t r = 0; r < runs.size(); ++r) {
      if (r == 0 || runs[r].part != runs[r - 1].part) add_node(runs[r].part);
      root_["meshes"].back()["primitives"].push_back(primitive(runs[r], alone));
    }
    for (const Material& material : look_.materials) add_material(material);
    root_["accessors"] = accessors_;
    root_["bufferViews"] = views_;
    root_["buffers"] = {{{"byteLength", data_.size()}}};
    return gltf::glb_container(file_, root_.dump(-1, ' ', false, Json::error_handler_t::replace), std::move(data_));
  }

 private:
  // Each primitive takes some 1 KB of the file and a call of whatever draws it.
  static constexpr std::size_t kMaxPrimitives = 4096;

  // Faces that follow one another in the file, of one part and material.
  struct Run {
    int part = -1, material = -1;
    std::vector<Index> faces;
  };

  std::vector<Run> runs_of_faces() const {
    std::vector<Run> runs;
    for (Index f = 0; f < mesh_.faces.rows(); ++f) {
      const auto face = static_cast<std::size_t>(f);
      const int part = look_.part_of_face.empty() ? -1 : look_.part_of_face[face];
      const int material = look_.material_of_face.empty() ? -1 : look_.material_of_face[face];
      if (runs.empty() || runs.back().part != part || runs.back().material != material) {
        runs.push_back({part, material, {}});
      }
      runs.back().faces.push_back(f);
    }
    return runs;
  }

  static std::vector<Run> joined(const std::vector<Run>& runs) {
    std::map<std::pair<int, int>, Run> all;
    for (const Run& run : runs) {
      Run& target = all.try_emplace({run.part, run.material}, Run{run.part, run.material, {}}).first->second;
      target.faces.insert(target.faces.end(), run.faces.begin(), run.faces.end());
    }
    std::vector<Run> result;
    for (auto& [key, run] : all) result.push_back(std::move(run));
    return result;
  }

  void add_node(int part) {
    Json node = Json::object();
    Json mesh = Json::object();
    if (part >= 0) {
      const Part& names = look_.parts[static_cast<std::size_t>(part)];
      if (!names.object.empty()) node["name"] = names.object;
      if (!names.group.empty()) mesh["name"] = names.group;
    }
    node["mesh"] = root_["meshes"].size();
    mesh["primitives"] = Json::array();
    root_["scenes"][0]["nodes"].push_back(root_["nodes"].size());
    root_["nodes"].push_back(node);
    root_["meshes"].push_back(mesh);
  }

  // Everything that a vertex of the file holds, as floats: place, normal, UV, colour.
  std::vector<float> row(Index corner) const {
    std::vector<float> values = place(mesh_.faces(corner / 3, corner % 3));
    const auto number = [](double value, double otherwise) {
      return static_cast<float>(std::isfinite(value) ? value : otherwise);
    };
    if (look_.normals.rows() > 0) {
      Eigen::RowVector3d normal = look_.normals.row(corner);
      if (!normal.allFinite() || std::abs(normal.norm() - 1) > 1e-3)
        normal = face_normal(mesh_, corner / 3).transpose();
      if (!(normal.norm() > 0.5)) normal = Eigen::RowVector3d::UnitZ();
      for (int k = 0; k < 3; ++k) values.push_back(number(normal[k], 0));
    }
    if (look_.uvs.rows() > 0) {
      values.push_back(number(look_.uvs(corner, 0), 0));
      values.push_back(number(1 - look_.uvs(corner, 1), 0));
    }
    for (int k = 0; look_.colours.rows() > 0 && k < 4; ++k) values.push_back(number(look_.colours(corner, k), 1));
    return values;
  }

  std::vector<float> place(int vertex) const {
    std::vector<float> values;
    for (int k = 0; k < 3; ++k) values.push_back(to_float(file_, mesh_.vertices(vertex, k)));
    return values;
  }

  // That of a vertex without a face.
  std::vector<float> unused_row(int vertex) const {
    std::vector<float> values = place(vertex);
    if (look_.normals.rows() > 0) values.insert(values.end(), {0, 0, 1});
    if (look_.uvs.rows() > 0) values.insert(values.end(), 2, 0);
    if (look_.colours.rows() > 0) values.insert(values.end(), 4, 1);
    return values;
  }

  // \param all  vertices, also those without a face
  Json primitive(const Run& run, bool all) {
    // Vertices of the mesh stay apart, even where they are in one place.
    std::map<std::pair<int, std::vector<float>>, std::uint32_t> numbers;
    std::vector<decltype(numbers)::iterator> corners;
    corners.reserve(3 * run.faces.size());
    std::vector<bool> used(static_cast<std::size_t>(mesh_.vertices.rows()));
    for (const Index f : run.faces) {
      for (int k = 0; k < 3; ++k) {
        const int vertex = mesh_.faces(f, k);
        corners.push_back(numbers.try_emplace({vertex, row(3 * f + k)}, 0).first);
        used[static_cast<std::size_t>(vertex)] = true;
      }
    }
    for (int v = 0; all && v < static_cast<int>(used.size()); ++v) {
      if (!used[static_cast<std::size_t>(v)]) numbers.try_emplace({v, unused_row(v)}, 0);
    }
    std::vector<std::vector<float>> rows;
    rows.reserve(numbers.size());
    for (auto& [key, number] : numbers) {
      number = static_cast<std::uint32_t>(rows.size());
      rows.push_back(key.second);
    }
    std::string indices;
    for (const auto& corner : corners) store(indices, corner->second);
    Json attributes;
    std::size_t first = 0;
    const auto add = [&](const char* name, std::size_t width) {
      attributes[name] = add_attribute(rows, first, width);
      first += width;
    };
    add("POSITION", 3);
    if (look_.normals.rows() > 0) add("NORMAL", 3);
    if (look_.uvs.rows() > 0) add("TEXCOORD_0", 2);
    if (look_.colours.rows() > 0) add("COLOR_0", 4);
    Json result{{"attributes", attributes}};
    result["indices"] = accessors_.size();
    accessors_.push_back({{"bufferView", add_view(indices, 34963)},
                          {"componentType", int{gltf::kUnsignedInt}},
                          {"count", corners.size()},
                          {"type", "SCALAR"}});
    if (run.material >= 0) result["material"] = run.material;
    return result;
  }

  std::size_t add_attribute(const std::vector<std::vector<float>>& rows, std::size_t first, std::size_t width) {
    std::string bytes;
    std::vector<float> low(rows.front().begin() + static_cast<std::ptrdiff_t>(first),
                           rows.front().begin() + static_cast<std::ptrdiff_t>(first + width));
    std::vector<float> high = low;
    for (const std::vector<float>& values : rows) {
      for (std::size_t k = 0; k < width; ++k) {
        store(bytes, values[first + k]);
        low[k] = std::min(low[k], values[first + k]);
        high[k] = std::max(high[k], values[first + k]);
      }
    }
    Json accessor{{"bufferView", add_view(bytes, 34962)},
                  {"componentType", int{gltf::kFloat}},
                  {"count", rows.size()},
                  {"type", "VEC" + std::to_string(width)}};
    if (first == 0) {
      accessor["min"] = low;
      accessor["max"] = high;
    }
    accessors_.push_back(accessor);
    return accessors_.size() - 1;
  }

  std::size_t add_view(std::string_view bytes, int target) {
    Json view{{"buffer", 0}, {"byteOffset", data_.size()}, {"byteLength", bytes.size()}};
    if (target != 0) view["target"] = target;
    data_ += bytes;
    data_.resize((data_.size() + 3) / 4 * 4, '\0');
    views_.push_back(view);
    return views_.size() - 1;
  }

  void add_material(const Material& material) {
    Json surface{{"baseColorFactor", material.base_colour}, {"metallicFactor", 0}};
    if (const int texture = add_texture(material); texture >= 0) surface["baseColorTexture"] = {{"index", texture}};
    Json entry{{"name", material.name}, {"pbrMetallicRoughness", surface}};
    if (material.base_colour[3] < 1) entry["alphaMode"] = "BLEND";
    root_["materials"].push_back(entry);
  }

  int add_texture(const Material& material) {
    if (material.texture.empty() && material.image.empty()) return -1;
    const std::string type = image_type(material.image);
    const auto [known, added] =
        textures_.try_emplace({material.texture, material.image}, static_cast<int>(textures_.size()));
    if (!added) return known->second;
    Json image;
    if (type.empty()) {
      image["uri"] = as_uri(material.texture);  // missing, or of a kind that a GLB cannot hold
    } else {
      if (!material.texture.empty()) image["name"] = material.texture;
      image["bufferView"] = add_view(material.image, 0);
      image["mimeType"] = type;
    }
    root_["images"].push_back(image);
    root_["textures"].push_back({{"source", known->second}});
    return known->second;
  }

  const std::filesystem::path& file_;
  const Mesh& mesh_;
  const Appearance& look_;
  Json root_, accessors_ = Json::array(), views_ = Json::array();
  std::string data_;
  std::map<std::pair<std::string, std::string>, int> textures_;
};

}  // namespace

std::string glb_with_look(const std::filesystem::path& file, const Mesh& mesh, const Appearance& look,
                          std::vector<std::string>& problems) {
  return GlbWriter(file, mesh, look).write(problems);
}

}  // namespace orbifit

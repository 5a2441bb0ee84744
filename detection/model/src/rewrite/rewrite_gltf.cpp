#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "files/gltf.h"
#include "files/gltf_file.h"
#include "files/gltf_plain.h"
#include "files/mesh_formats.h"
#include "rewrite/rewriters.h"
#include "rewrite/turned_normals.h"

namespace orbifit {

namespace {

using gltf::PrimitiveUse;
using Json = GltfFile::Json;

// What an attribute shall hold; rows that nothing asks for stay as they are.
struct Target {
  std::int64_t accessor = 0;
  GltfAttribute attribute;
  std::vector<bool> asked;  // for each row
  bool changed = false;

  bool agrees(std::size_t row, const std::array<float, 4>& value) const {
    if (!asked[row]) return true;
    for (std::size_t k = 0; k < components(); ++k) {
      if (attribute.values[row * components() + k] != value[k]) return false;
    }
    return true;
  }

  void ask(std::size_t row, const std::array<float, 4>& value) {
    asked[row] = true;
    for (std::size_t k = 0; k < components(); ++k) {
      float& entry = attribute.values[row * components() + k];
      changed = changed || entry != value[k];
      entry = value[k];
    }
  }

  std::size_t components() const { return static_cast<std::size_t>(attribute.components); }
};

// Attributes that several uses share stay shared as long as they ask for the same; a use that asks for something else
// gets numbers of its own, and a copy of the mesh where another node has that.
class GltfRewriter {
 public:
  explicit GltfRewriter(const MeshEdit& edit)
      : edit_(edit),
        plain_(gltf::plain(edit.source, edit.content)),
        file_(edit.source, plain_.text(edit.content)),
        turns_(vertex_normal_turns(edit.rest, edit.edited)),
        uses_(gltf::primitive_uses(edit.source, edit.content)) {}

  std::string run() {
    for (const PrimitiveUse& use : uses_) apply(use);
    for (auto& [accessor, target] : targets_) {
      if (target.changed) write(target);
    }
    return file_.bytes();
  }

 private:
  enum class Kind { position, normal, tangent };

  void apply(const PrimitiveUse& use) {
    if (use.node != node_) {
      node_ = use.node;
      split_.clear();
      own_mesh_ = mesh_of_.emplace(use.mesh, use.node).first->second == use.node ? use.mesh : -1;
    }
    const Json primitive = file_.root()["meshes"][index(use.mesh)]["primitives"][index(use.primitive)];
    const std::vector<std::size_t> rows = used_rows(primitive);
    for (const auto& [name, kind] : {std::pair{"POSITION", Kind::position}, std::pair{"NORMAL", Kind::normal},
                                     std::pair{"TANGENT", Kind::tangent}}) {
      if (!primitive["attributes"].contains(name)) continue;
      ask(use, name, kind, primitive, rows);
    }
  }

  std::vector<std::size_t> used_rows(const Json& primitive) {
    const auto position = primitive["attributes"]["POSITION"].get<std::int64_t>();
    std::vector<bool> used(file_.root()["accessors"][index(position)]["count"].get<std::size_t>());
    if (const auto corners = file_.corners(primitive)) {
      for (const std::int64_t corner : *corners) used[index(corner)] = true;
    } else {
      used.assign(used.size(), true);
    }
    std::vector<std::size_t> rows;
    for (std::size_t v = 0; v < used.size(); ++v) {
      if (used[v]) rows.push_back(v);
    }
    return rows;
  }

  void ask(const PrimitiveUse& use, const char* name, Kind kind, const Json& primitive,
           const std::vector<std::size_t>& rows) {
    const Json& attributes = primitive["attributes"];
    const auto position = index(attributes["POSITION"].get<std::int64_t>());
    const GltfAttribute rest =
        file_.attribute(attributes[name], file_.root()["accessors"][position]["count"].get<std::int64_t>(),
                        "meshes[" + std::to_string(use.mesh) + "]." + name);
    if (rest.components < 3) return;  // neither a normal nor a tangent
    const auto accessor = attributes[name].get<std::int64_t>();
    std::vector<std::array<float, 4>> values;
    for (const std::size_t row : rows) values.push_back(edited(use, kind, rest, row));
    const auto agrees = [&](const Target& target) {
      for (std::size_t i = 0; i < rows.size(); ++i) {
        if (!target.agrees(rows[i], values[i])) return false;
      }
      return true;
    };
    const auto assign = [&](Target& target) {
      for (std::size_t i = 0; i < rows.size(); ++i) target.ask(rows[i], values[i]);
    };
    Target& shared = target_of(accessor, rest);
    if (agrees(shared)) return assign(shared);
    Target* own = split_.contains(accessor) ? &targets_.at(split_.at(accessor)) : nullptr;
    if (own == nullptr || !agrees(*own)) {
      const std::int64_t added = file_.add(accessor, rest);
      own = &target_of(added, rest);
      split_[accessor] = added;
    }
    assign(*own);
    own_mesh(use)["primitives"][index(use.primitive)]["attributes"][name] = own->accessor;
  }

  // An attribute of a vertex as it is after the edit, in the node's frame.
  std::array<float, 4> edited(const PrimitiveUse& use, Kind kind, const GltfAttribute& rest, std::size_t row) const {
    std::array<float, 4> value{};
    const auto components = static_cast<std::size_t>(rest.components);
    for (std::size_t k = 0; k < components; ++k) value[k] = rest.values[row * components + k];
    const auto vertex = use.first_vertex + static_cast<Eigen::Index>(row);
    const Eigen::Matrix3d linear = use.world.topLeftCorner<3, 3>();
    Eigen::Vector3d result;
    if (kind == Kind::position) {
      if (edit_.edited.vertices.row(vertex) == edit_.rest.vertices.row(vertex)) return value;
      const Eigen::Vector3d moved = edit_.edited.vertices.row(vertex).transpose() - use.world.topRightCorner<3, 1>();
      result = linear.colPivHouseholderQr().solve(moved);
    } else {
      const Eigen::Vector3d local(value[0], value[1], value[2]);
      const bool normal = kind == Kind::normal;
      const Eigen::Matrix3d out = normal ? Eigen::Matrix3d(linear.inverse().transpose()) : linear;
      const Eigen::Vector3d world = out * local;
      const Eigen::Vector3d turned = turns_[index(vertex)].apply(world);
      if (turned == world || !turned.allFinite()) return value;
      result = out.inverse() * turned;
      if (!(result.norm() > 0) || !result.allFinite()) return value;
      result *= local.norm() / result.norm();
    }
    for (std::size_t k = 0; k < 3; ++k) value[k] = to_float(edit_.source, result[static_cast<Eigen::Index>(k)]);
    return value;
  }

  Target& target_of(std::int64_t accessor, const GltfAttribute& rest) {
    const auto [found, is_new] = targets_.try_emplace(accessor);
    if (is_new) {
      const std::size_t count = rest.values.size() / static_cast<std::size_t>(rest.components);
      found->second = {accessor, rest, std::vector<bool>(count), false};
    }
    return found->second;
  }

  // The mesh that only this node has.
  Json& own_mesh(const PrimitiveUse& use) {
    Json& meshes = file_.root()["meshes"];
    if (own_mesh_ < 0) {
      own_mesh_ = static_cast<std::int64_t>(meshes.size());
      meshes.push_back(Json(meshes[index(use.mesh)]));
      file_.root()["nodes"][index(use.node)]["mesh"] = own_mesh_;
    }
    return meshes[index(own_mesh_)];
  }

  void write(const Target& target) {
    if (file_.writable(target.accessor)) return file_.set(target.accessor, target.attribute);
    const std::int64_t added = file_.add(target.accessor, target.attribute);
    for (Json& mesh : file_.root()["meshes"]) {
      for (Json& primitive : mesh["primitives"]) {
        for (const char* name : {"POSITION", "NORMAL", "TANGENT"}) {
          Json& attributes = primitive["attributes"];
          if (attributes.contains(name) && attributes[name] == target.accessor) attributes[name] = added;
        }
      }
    }
  }

  static std::size_t index(std::int64_t number) { return static_cast<std::size_t>(number); }

  const MeshEdit& edit_;
  gltf::Plain plain_;
  GltfFile file_;
  std::vector<NormalTurn> turns_;
  std::vector<PrimitiveUse> uses_;
  std::map<std::int64_t, Target> targets_;        // by accessor
  std::map<std::int64_t, std::int64_t> mesh_of_;  // the first node that has each mesh
  std::int64_t node_ = -1;                        // whose primitives are looked at
  std::int64_t own_mesh_ = -1;                    // which that node alone has; -1: none yet
  std::map<std::int64_t, std::int64_t> split_;    // accessors of the node that took the place of shared ones
};

}  // namespace

std::string rewritten_gltf(const MeshEdit& edit) {
  if (edit.edited.vertices == edit.rest.vertices) return std::string(edit.content);
  return GltfRewriter(edit).run();
}

}  // namespace orbifit

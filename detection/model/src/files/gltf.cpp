#include "files/gltf.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "files/binary.h"
#include "files/gltf_document.h"
#include "files/gltf_plain.h"
#include "files/mesh_formats.h"

namespace orbifit {

namespace fs = std::filesystem;

namespace {

using namespace gltf;
using Json = Document::Json;

class GltfReader {
 public:
  GltfReader(const fs::path& file, std::string_view content, MeshBuilder& builder)
      : plain_(plain(file, content)), document_(file, plain_.text(content)), builder_(builder) {}

  void read() {
    const Json* asset = Document::find(document_.root(), "asset");
    const Json* version = asset != nullptr ? Document::find(*asset, "version") : nullptr;
    if (version == nullptr || !version->is_string() || !version->get_ref<const std::string&>().starts_with("2")) {
      document_.refuse("asset.version", "only glTF 2 is read");
    }
    nodes_ = document_.list("nodes");
    entered_.assign(nodes_ == nullptr ? 0 : nodes_->size(), false);
    for (const std::int64_t root : root_nodes()) visit_tree(root);
  }

  const std::vector<PrimitiveUse>& uses() const { return uses_; }

 private:
  std::vector<std::int64_t> root_nodes() const {
    const Json* scenes = document_.list("scenes");
    if (scenes != nullptr && !scenes->empty()) {
      const std::int64_t number = document_.integer(document_.root(), "scene", 0, "");
      return document_.node_list(document_.item("scenes", number, "scene"), "nodes",
                                 "scenes[" + std::to_string(number) + "]");
    }
    std::vector<std::int64_t> roots;
    std::vector<bool> child(entered_.size(), false);
    for (std::size_t n = 0; n < child.size(); ++n) {
      for (const std::int64_t c : document_.node_list((*nodes_)[n], "children", "nodes[" + std::to_string(n) + "]")) {
        child[static_cast<std::size_t>(c)] = true;
      }
    }
    for (std::size_t n = 0; n < child.size(); ++n) {
      if (!child[n]) roots.push_back(static_cast<std::int64_t>(n));
    }
    return roots;
  }

  Eigen::Matrix4d transform(const Json& node, const std::string& where) const {
    Eigen::Matrix4d result = Eigen::Matrix4d::Identity();
    std::array<double, 16> matrix{};
    if (document_.numbers(node, "matrix", matrix, where)) {
      result = Eigen::Map<const Eigen::Matrix4d>(matrix.data());
      if (result.row(3) != Eigen::RowVector4d(0, 0, 0, 1))
        document_.refuse(where + ".matrix", "must end its columns with 0 0 0 1");
      return result;
    }
    std::array<double, 3> translation{0, 0, 0};
    std::array<double, 4> rotation{0, 0, 0, 1};  // x, y, z, w
    std::array<double, 3> scale{1, 1, 1};
    document_.numbers(node, "translation", translation, where);
    document_.numbers(node, "rotation", rotation, where);
    document_.numbers(node, "scale", scale, where);
    const Eigen::Quaterniond turn(rotation[3], rotation[0], rotation[1], rotation[2]);
    if (!(turn.norm() > 0)) document_.refuse(where + ".rotation", "must be a unit quaternion");
    result.topLeftCorner<3, 3>() =
        turn.normalized().toRotationMatrix() * Eigen::Vector3d(scale[0], scale[1], scale[2]).asDiagonal();
    result.topRightCorner<3, 1>() = Eigen::Vector3d(translation[0], translation[1], translation[2]);
    return result;
  }

  // Depth first, children in order; with a stack of our own, so that no depth overflows the call stack.
  void visit_tree(std::int64_t root) {
    struct Open {
      std::int64_t node;
      Eigen::Matrix4d parent;
    };
    std::vector<Open> stack{{root, Eigen::Matrix4d::Identity()}};
    while (!stack.empty()) {
      const Open open = stack.back();
      stack.pop_back();
      const std::string where = "nodes[" + std::to_string(open.node) + "]";
      const Json& node = document_.item("nodes", open.node, where);
      if (entered_[static_cast<std::size_t>(open.node)])
        document_.refuse(where, "is reached twice: the nodes must form a tree");
      entered_[static_cast<std::size_t>(open.node)] = true;
      const Eigen::Matrix4d world = open.parent * transform(node, where);
      if (const std::int64_t mesh = document_.integer(node, "mesh", -1, where); mesh >= 0)
        add_mesh(open.node, mesh, world);
      const auto children = document_.node_list(node, "children", where);
      for (auto child = children.rbegin(); child != children.rend(); ++child) stack.push_back({*child, world});
    }
  }

  void add_mesh(std::int64_t node, std::int64_t number, const Eigen::Matrix4d& world) {
    const std::string where = "meshes[" + std::to_string(number) + "]";
    const Json* primitives = Document::find(document_.item("meshes", number, where), "primitives");
    if (primitives == nullptr || !primitives->is_array()) document_.refuse(where + ".primitives", "must be a list");
    for (std::size_t p = 0; p < primitives->size(); ++p) {
      const std::int64_t first = builder_.vertices();
      add_primitive((*primitives)[p], where + ".primitives[" + std::to_string(p) + "]", world);
      if (builder_.vertices() > first) uses_.push_back({node, number, static_cast<std::int64_t>(p), first, world});
    }
  }

  void add_primitive(const Json& primitive, const std::string& where, const Eigen::Matrix4d& world) {
    enum Mode { kTriangles = 4, kStrip, kFan };
    const std::int64_t mode = document_.integer(primitive, "mode", kTriangles, where);
    if (mode < kTriangles) return;  // points and lines
    if (mode > kFan) document_.refuse(where + ".mode", "is " + std::to_string(mode) + ": modes go from 0 to 6");
    const Json* attributes = Document::find(primitive, "attributes");
    const std::int64_t position =
        attributes == nullptr ? -1 : document_.integer(*attributes, "POSITION", -1, where + ".attributes");
    if (position < 0) document_.refuse(where, "has no POSITION");
    const std::int64_t first = builder_.vertices();
    const Accessor points = document_.accessor(position, 3, "positions");
    if (first + points.count > kMostVertices) document_.refuse(where, "too many vertices");
    const bool moved = !world.isIdentity(0);
    for (std::int64_t v = 0; v < points.count; ++v) {
      const Eigen::Vector3d local(points.value(v, 0), points.value(v, 1), points.value(v, 2));
      const Eigen::Vector3d point = moved ? Eigen::Vector3d((world * local.homogeneous()).head<3>()) : local;
      builder_.add_vertex({point.x(), point.y(), point.z()}, 0);
    }
    const std::vector<std::int64_t> corners = corners_of(primitive, where, points.count);
    if (mode == kTriangles && corners.size() % 3 != 0) {
      document_.refuse(where, std::to_string(corners.size()) + " corners: triangles need a multiple of 3");
    }
    // A transform that mirrors turns the triangles over; the specification has their orientation follow.
    const bool mirrored = world.topLeftCorner<3, 3>().determinant() < 0;
    const std::size_t step = mode == kTriangles ? 3 : 1;
    for (std::size_t i = 0; i + 2 < corners.size(); i += step) {
      std::int64_t triangle[3] = {first + corners[i], first + corners[i + 1], first + corners[i + 2]};
      if (mode == kFan) triangle[0] = first + corners[0];
      if ((mode == kStrip && i % 2 == 1) != mirrored) std::swap(triangle[1], triangle[2]);
      builder_.add_polygon(triangle, 0);
    }
  }

  // The numbers of its corners' vertices, among its own.
  std::vector<std::int64_t> corners_of(const Json& primitive, const std::string& where, std::int64_t vertices) {
    std::vector<std::int64_t> corners;
    if (const std::int64_t indices = document_.integer(primitive, "indices", -1, where); indices >= 0) {
      const Accessor numbers = document_.accessor(indices, 1, "indices");
      if (numbers.type == kFloat || numbers.type == kByte || numbers.type == kShort) {
        document_.refuse("accessors[" + std::to_string(indices) + "].componentType",
                         "is " + std::to_string(numbers.type) + ": indices must be unsigned");
      }
      corners.reserve(static_cast<std::size_t>(numbers.count));
      for (std::int64_t i = 0; i < numbers.count; ++i)
        corners.push_back(static_cast<std::int64_t>(numbers.value(i, 0)));
    } else {
      for (std::int64_t v = 0; v < vertices; ++v) corners.push_back(v);
    }
    for (const std::int64_t corner : corners) {
      if (corner < 0 || corner >= vertices) {
        document_.refuse(where + ".indices", "vertex index " + std::to_string(corner) +
                                                 " is out of range: the primitive has " + std::to_string(vertices) +
                                                 " vertices");
      }
    }
    return corners;
  }

  Plain plain_;
  Document document_;
  MeshBuilder& builder_;
  const Json* nodes_ = nullptr;
  std::vector<bool> entered_;
  std::vector<PrimitiveUse> uses_;
};

}  // namespace

namespace gltf {

std::size_t component_size(std::int64_t type) {
  switch (type) {
    case kByte:
    case kUnsignedByte:
      return 1;
    case kShort:
    case kUnsignedShort:
      return 2;
    case kUnsignedInt:
    case kFloat:
      return 4;
    default:
      return 0;
  }
}

double load_component(const char* bytes, std::int64_t type, bool normalised) {
  switch (type) {
    case kByte: {
      const double value = load<std::int8_t>(bytes);
      return normalised ? std::max(value / 127, -1.0) : value;
    }
    case kUnsignedByte: {
      const double value = load<std::uint8_t>(bytes);
      return normalised ? value / 255 : value;
    }
    case kShort: {
      const double value = load<std::int16_t>(bytes);
      return normalised ? std::max(value / 32767, -1.0) : value;
    }
    case kUnsignedShort: {
      const double value = load<std::uint16_t>(bytes);
      return normalised ? value / 65535 : value;
    }
    case kUnsignedInt:
      return load<std::uint32_t>(bytes);
    default:
      return load<float>(bytes);
  }
}

std::optional<std::string> decode_base64(std::string_view text) {
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3);
  std::uint32_t bits = 0;
  int held = 0;
  for (const char c : text) {
    int value = 0;
    if (c >= 'A' && c <= 'Z') {
      value = c - 'A';
    } else if (c >= 'a' && c <= 'z') {
      value = c - 'a' + 26;
    } else if (c >= '0' && c <= '9') {
      value = c - '0' + 52;
    } else if (c == '+' || c == '/') {
      value = c == '+' ? 62 : 63;
    } else if (c == '=') {
      break;
    } else {
      return std::nullopt;
    }
    bits = (bits << 6U) | static_cast<std::uint32_t>(value);
    held += 6;
    if (held >= 8) {
      held -= 8;
      bytes.push_back(static_cast<char>((bits >> static_cast<unsigned>(held)) & 0xFFU));
    }
  }
  return bytes;
}

std::string decode_percent(std::string_view text) {
  const auto hex = [](char c) {
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                  : -1;
  };
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '%' && i + 2 < text.size() && hex(text[i + 1]) >= 0 && hex(text[i + 2]) >= 0) {
      result.push_back(static_cast<char>(16 * hex(text[i + 1]) + hex(text[i + 2])));
      i += 2;
    } else {
      result.push_back(text[i]);
    }
  }
  return result;
}

std::vector<PrimitiveUse> primitive_uses(const fs::path& file, std::string_view content) {
  MeshBuilder builder(file.string());
  GltfReader reader(file, content, builder);
  reader.read();
  return reader.uses();
}

}  // namespace gltf

void read_gltf(const fs::path& file, std::string_view content, MeshBuilder& builder) {
  GltfReader(file, content, builder).read();
}

}  // namespace orbifit

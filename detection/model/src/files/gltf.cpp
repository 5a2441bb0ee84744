#include "files/gltf.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "orbifit/model/errors.h"

#include "files/binary.h"
#include "files/file.h"
#include "files/json_text.h"
#include "files/mesh_formats.h"
#include "files/text.h"

namespace orbifit {

namespace fs = std::filesystem;

namespace {

using Json = nlohmann::json;
using namespace gltf;

constexpr std::int64_t kMaxVertices = 200'000'000;

class GltfReader {
 public:
  GltfReader(const fs::path& file, std::string_view content, MeshBuilder& builder) : file_(file), builder_(builder) {
    const bool binary = content.size() >= 4 && load<std::uint32_t>(content.data()) == kMagic;
    const std::string_view text = binary ? split(content) : content;
    root_ = parse_json(file.string(), text);
    if (!root_.is_object()) refuse("", "not a glTF file: it holds no JSON object");
  }

  void read() {
    const Json* asset = find(root_, "asset");
    const Json* version = asset != nullptr ? find(*asset, "version") : nullptr;
    if (version == nullptr || !version->is_string() || !version->get_ref<const std::string&>().starts_with("2")) {
      refuse("asset.version", "only glTF 2 is read");
    }
    nodes_ = list("nodes");
    entered_.assign(nodes_ == nullptr ? 0 : nodes_->size(), false);
    for (const std::int64_t root : root_nodes()) visit_tree(root);
  }

  const std::vector<PrimitiveUse>& uses() const { return uses_; }

 private:
  [[noreturn]] void refuse(const std::string& where, const std::string& reason) const {
    throw InputError(file_.string(), where, reason);
  }

  // The JSON text of a GLB; remembers its binary chunk.
  std::string_view split(std::string_view content) {
    if (content.size() < 20) refuse("", "the file is truncated: not even a GLB header fits");
    if (load<std::uint32_t>(content.data() + 4) != 2) refuse("", "only version 2 of GLB is read");
    std::string_view text;
    std::size_t at = 12;
    for (int chunk = 0; at + 8 <= content.size(); ++chunk) {
      const std::size_t length = load<std::uint32_t>(content.data() + at);
      const std::uint32_t type = load<std::uint32_t>(content.data() + at + 4);
      at += 8;
      if (length > content.size() - at) {
        refuse("chunk " + std::to_string(chunk), "the file is truncated: it announces " + std::to_string(length) +
                                                     " bytes, " + std::to_string(content.size() - at) + " are left");
      }
      if (chunk == 0 && type != kJsonChunk) refuse("chunk 0", "must hold JSON");
      if (chunk == 0) text = content.substr(at, length);
      if (chunk == 1 && type == kBinChunk) binary_chunk_ = content.substr(at, length);
      at += length;
    }
    return text;
  }

  static const Json* find(const Json& object, const char* key) {
    const auto found = object.is_object() ? object.find(key) : object.end();
    return object.is_object() && found != object.end() ? &*found : nullptr;
  }

  // A list at the top level, or null.
  const Json* list(const char* key) const {
    const Json* found = find(root_, key);
    if (found != nullptr && !found->is_array()) refuse(key, "must be a list");
    return found;
  }

  const Json& item(const char* key, std::int64_t index, const std::string& user) const {
    const Json* found = list(key);
    const std::int64_t size = found == nullptr ? 0 : static_cast<std::int64_t>(found->size());
    if (index < 0 || index >= size) {
      refuse(user,
             "names " + std::string(key) + "[" + std::to_string(index) + "], but there are " + std::to_string(size));
    }
    const Json& result = (*found)[static_cast<std::size_t>(index)];
    if (!result.is_object()) refuse(std::string(key) + "[" + std::to_string(index) + "]", "must be an object");
    return result;
  }

  std::int64_t integer(const Json& object, const char* key, std::int64_t otherwise, const std::string& where) const {
    const Json* found = find(object, key);
    if (found == nullptr) return otherwise;
    if (!found->is_number_integer() || found->get<double>() < 0 || found->get<double>() > 9e15) {
      refuse(where.empty() ? key : where + "." + key, "must be an integer, at least 0");
    }
    return found->get<std::int64_t>();
  }

  template <std::size_t Size>
  bool numbers(const Json& object, const char* key, std::array<double, Size>& result, const std::string& where) const {
    const Json* found = find(object, key);
    if (found == nullptr) return false;
    const bool good = found->is_array() && found->size() == Size &&
                      std::ranges::all_of(*found, [](const Json& entry) { return entry.is_number(); });
    if (!good) refuse(where + "." + key, "must be a list of " + std::to_string(Size) + " numbers");
    for (std::size_t k = 0; k < Size; ++k) result[k] = (*found)[k].get<double>();
    return true;
  }

  std::vector<std::int64_t> node_list(const Json& object, const char* key, const std::string& where) const {
    std::vector<std::int64_t> result;
    const Json* found = find(object, key);
    if (found == nullptr) return result;
    if (!found->is_array()) refuse(where + "." + key, "must be a list");
    for (const Json& entry : *found) {
      if (!entry.is_number_integer()) refuse(where + "." + key, "must be a list of node numbers");
      result.push_back(entry.get<std::int64_t>());
      item("nodes", result.back(), where + "." + key);
    }
    return result;
  }

  std::vector<std::int64_t> root_nodes() const {
    const Json* scenes = list("scenes");
    if (scenes != nullptr && !scenes->empty()) {
      const std::int64_t number = integer(root_, "scene", 0, "");
      return node_list(item("scenes", number, "scene"), "nodes", "scenes[" + std::to_string(number) + "]");
    }
    std::vector<std::int64_t> roots;
    std::vector<bool> child(entered_.size(), false);
    for (std::size_t n = 0; n < child.size(); ++n) {
      for (const std::int64_t c : node_list((*nodes_)[n], "children", "nodes[" + std::to_string(n) + "]")) {
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
    if (numbers(node, "matrix", matrix, where)) {
      result = Eigen::Map<const Eigen::Matrix4d>(matrix.data());
      if (result.row(3) != Eigen::RowVector4d(0, 0, 0, 1))
        refuse(where + ".matrix", "must end its columns with 0 0 0 1");
      return result;
    }
    std::array<double, 3> translation{0, 0, 0};
    std::array<double, 4> rotation{0, 0, 0, 1};  // x, y, z, w
    std::array<double, 3> scale{1, 1, 1};
    numbers(node, "translation", translation, where);
    numbers(node, "rotation", rotation, where);
    numbers(node, "scale", scale, where);
    const Eigen::Quaterniond turn(rotation[3], rotation[0], rotation[1], rotation[2]);
    if (!(turn.norm() > 0)) refuse(where + ".rotation", "must be a unit quaternion");
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
      const Json& node = item("nodes", open.node, where);
      if (entered_[static_cast<std::size_t>(open.node)]) refuse(where, "is reached twice: the nodes must form a tree");
      entered_[static_cast<std::size_t>(open.node)] = true;
      const Eigen::Matrix4d world = open.parent * transform(node, where);
      const Json* extensions = find(node, "extensions");
      if (extensions != nullptr && find(*extensions, "EXT_mesh_gpu_instancing") != nullptr) {
        refuse(where, "the extension EXT_mesh_gpu_instancing is not read");
      }
      if (const std::int64_t mesh = integer(node, "mesh", -1, where); mesh >= 0) add_mesh(open.node, mesh, world);
      const auto children = node_list(node, "children", where);
      for (auto child = children.rbegin(); child != children.rend(); ++child) stack.push_back({*child, world});
    }
  }

  void add_mesh(std::int64_t node, std::int64_t number, const Eigen::Matrix4d& world) {
    const std::string where = "meshes[" + std::to_string(number) + "]";
    const Json* primitives = find(item("meshes", number, where), "primitives");
    if (primitives == nullptr || !primitives->is_array()) refuse(where + ".primitives", "must be a list");
    for (std::size_t p = 0; p < primitives->size(); ++p) {
      const std::int64_t first = builder_.vertices();
      add_primitive((*primitives)[p], where + ".primitives[" + std::to_string(p) + "]", world);
      if (builder_.vertices() > first) uses_.push_back({node, number, static_cast<std::int64_t>(p), first, world});
    }
  }

  void add_primitive(const Json& primitive, const std::string& where, const Eigen::Matrix4d& world) {
    enum Mode { kTriangles = 4, kStrip, kFan };
    const std::int64_t mode = integer(primitive, "mode", kTriangles, where);
    if (mode < kTriangles) return;  // points and lines
    if (mode > kFan) refuse(where + ".mode", "is " + std::to_string(mode) + ": modes go from 0 to 6");
    const Json* extensions = find(primitive, "extensions");
    if (extensions != nullptr && find(*extensions, "KHR_draco_mesh_compression") != nullptr) {
      refuse(where, "is compressed with Draco (KHR_draco_mesh_compression), which is not read: export it uncompressed");
    }
    const Json* attributes = find(primitive, "attributes");
    const std::int64_t position =
        attributes == nullptr ? -1 : integer(*attributes, "POSITION", -1, where + ".attributes");
    if (position < 0) refuse(where, "has no POSITION");
    const std::int64_t first = builder_.vertices();
    const Accessor points = accessor(position, 3);
    if (first + points.count > kMaxVertices) refuse(where, "too many vertices");
    const bool moved = !world.isIdentity(0);
    for (std::int64_t v = 0; v < points.count; ++v) {
      const Eigen::Vector3d local(points.value(v, 0), points.value(v, 1), points.value(v, 2));
      const Eigen::Vector3d point = moved ? Eigen::Vector3d((world * local.homogeneous()).head<3>()) : local;
      builder_.add_vertex({point.x(), point.y(), point.z()}, 0);
    }
    std::vector<std::int64_t> corners;
    if (const std::int64_t indices = integer(primitive, "indices", -1, where); indices >= 0) {
      const Accessor numbers = accessor(indices, 1);
      if (numbers.type == kFloat || numbers.type == kByte || numbers.type == kShort) {
        refuse("accessors[" + std::to_string(indices) + "].componentType",
               "is " + std::to_string(numbers.type) + ": indices must be unsigned");
      }
      corners.reserve(static_cast<std::size_t>(numbers.count));
      for (std::int64_t i = 0; i < numbers.count; ++i)
        corners.push_back(static_cast<std::int64_t>(numbers.value(i, 0)));
    } else {
      for (std::int64_t v = 0; v < points.count; ++v) corners.push_back(v);
    }
    for (const std::int64_t corner : corners) {
      if (corner < 0 || corner >= points.count) {
        refuse(where + ".indices", "vertex index " + std::to_string(corner) + " is out of range: the primitive has " +
                                       std::to_string(points.count) + " vertices");
      }
    }
    if (mode == kTriangles && corners.size() % 3 != 0) {
      refuse(where, std::to_string(corners.size()) + " corners: triangles need a multiple of 3");
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

  // Numbers in a buffer, all of them inside it.
  struct Accessor {
    const char* data = nullptr;
    std::int64_t count = 0;
    std::size_t stride = 0;
    std::size_t size = 0;  // of one component
    std::int64_t type = 0;
    bool normalised = false;

    double value(std::int64_t row, std::size_t component) const {
      return load_component(data + static_cast<std::size_t>(row) * stride + component * size, type, normalised);
    }
  };

  Accessor accessor(std::int64_t number, std::size_t components) {
    const std::string where = "accessors[" + std::to_string(number) + "]";
    const Json& entry = item("accessors", number, where);
    const Json* type = find(entry, "type");
    if (type == nullptr || *type != (components == 3 ? "VEC3" : "SCALAR")) {
      refuse(where + ".type", components == 3 ? "must be VEC3 for positions" : "must be SCALAR for indices");
    }
    if (find(entry, "sparse") != nullptr) refuse(where, "sparse accessors are not read");
    Accessor result;
    result.type = integer(entry, "componentType", -1, where);
    result.size = component_size(result.type);
    if (result.size == 0) refuse(where + ".componentType", "is " + std::to_string(result.type) + ": unknown");
    result.count = integer(entry, "count", 0, where);
    const Json* normalised = find(entry, "normalized");
    result.normalised = normalised != nullptr && normalised->is_boolean() && normalised->get<bool>();

    const std::int64_t view_number = integer(entry, "bufferView", -1, where);
    if (view_number < 0) refuse(where, "has no bufferView");
    const std::string view_where = "bufferViews[" + std::to_string(view_number) + "]";
    const Json& view = item("bufferViews", view_number, where);
    const Json* extensions = find(view, "extensions");
    if (extensions != nullptr && (find(*extensions, "EXT_meshopt_compression") != nullptr ||
                                  find(*extensions, "KHR_meshopt_compression") != nullptr)) {
      refuse(view_where, "is compressed (EXT_meshopt_compression), which is not read: export it uncompressed");
    }
    const std::string_view bytes = buffer(integer(view, "buffer", -1, view_where), view_where);
    const auto offset = static_cast<std::size_t>(integer(view, "byteOffset", 0, view_where));
    const auto length = static_cast<std::size_t>(integer(view, "byteLength", 0, view_where));
    if (offset > bytes.size() || length > bytes.size() - offset) refuse(view_where, "reaches beyond its buffer");
    const auto inner = static_cast<std::size_t>(integer(entry, "byteOffset", 0, where));
    const std::size_t row = components * result.size;
    result.stride = static_cast<std::size_t>(integer(view, "byteStride", static_cast<std::int64_t>(row), view_where));
    if (result.stride < row || result.stride > 4096) refuse(view_where + ".byteStride", "does not fit its data");
    const auto rows = static_cast<std::size_t>(result.count);
    if (rows > 0 && (inner > length || row > length - inner || rows - 1 > (length - inner - row) / result.stride)) {
      refuse(where, "reaches beyond its bufferView: " + std::to_string(result.count) + " entries are announced");
    }
    result.data = bytes.data() + offset + (rows > 0 ? inner : 0);
    return result;
  }

  std::string_view buffer(std::int64_t number, const std::string& user) {
    const std::string where = "buffers[" + std::to_string(number) + "]";
    const Json& entry = item("buffers", number, user);
    const Json* uri = find(entry, "uri");
    if (uri == nullptr) {
      if (number != 0 || binary_chunk_.empty()) refuse(where, "has no data");
      return binary_chunk_;
    }
    if (!uri->is_string()) refuse(where + ".uri", "must be a string");
    std::string& bytes = buffers_[number];
    if (!bytes.empty()) return bytes;
    const auto& text = uri->get_ref<const std::string&>();
    if (text.starts_with("data:")) {
      const std::size_t comma = text.find(";base64,");
      auto decoded =
          comma == std::string::npos ? std::nullopt : decode_base64(std::string_view(text).substr(comma + 8));
      if (!decoded) refuse(where + ".uri", "is no base64 data");
      bytes = std::move(*decoded);
    } else if (text.find("://") != std::string::npos) {
      refuse(where + ".uri", in_quotes(text) + ": only files are read");
    } else {
      const fs::path name = decode_percent(text);
      if (std::ranges::any_of(name.native(), [](char c) { return static_cast<unsigned char>(c) < ' '; })) {
        refuse(where + ".uri", in_quotes(name.native()) + " is no name of a file");
      }
      if (name.is_absolute() || std::ranges::any_of(name, [](const fs::path& part) { return part == ".."; })) {
        refuse(where + ".uri", in_quotes(text) + " leaves the file's folder: not read");
      }
      try {
        bytes = read_file(file_.parent_path() / name);
      } catch (const InputError& error) {
        refuse(where + ".uri", error.what());
      }
    }
    return bytes;
  }

  fs::path file_;
  MeshBuilder& builder_;
  Json root_;
  std::string_view binary_chunk_;
  std::map<std::int64_t, std::string> buffers_;
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

#include "files/gltf_document.h"

#include <optional>
#include <utility>

#include "orbifit/model/errors.h"

#include "files/binary.h"
#include "files/file.h"
#include "files/json_text.h"
#include "files/text.h"

namespace orbifit::gltf {

namespace fs = std::filesystem;

using Json = Document::Json;

Document::Document(const fs::path& file, std::string_view content) : file_(file) {
  const bool binary = content.size() >= 4 && load<std::uint32_t>(content.data()) == kMagic;
  const std::string_view text = binary ? split(content) : content;
  root_ = parse_json(file.string(), text);
  if (!root_.is_object()) refuse("", "not a glTF file: it holds no JSON object");
}

void Document::refuse(const std::string& where, const std::string& reason) const {
  throw InputError(file_.string(), where, reason);
}

// The JSON text of a GLB; remembers its binary chunk.
std::string_view Document::split(std::string_view content) {
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

const Json* Document::find(const Json& object, const char* key) {
  const auto found = object.is_object() ? object.find(key) : object.end();
  return object.is_object() && found != object.end() ? &*found : nullptr;
}

const Json* Document::list(const char* key) const {
  const Json* found = find(root_, key);
  if (found != nullptr && !found->is_array()) refuse(key, "must be a list");
  return found;
}

const Json& Document::item(const char* key, std::int64_t index, const std::string& user) const {
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

std::int64_t Document::integer(const Json& object, const char* key, std::int64_t otherwise,
                               const std::string& where) const {
  const Json* found = find(object, key);
  if (found == nullptr) return otherwise;
  if (!found->is_number_integer() || found->get<double>() < 0 || found->get<double>() > 9e15) {
    refuse(where.empty() ? key : where + "." + key, "must be an integer, at least 0");
  }
  return found->get<std::int64_t>();
}

std::vector<std::int64_t> Document::node_list(const Json& object, const char* key, const std::string& where) const {
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

Accessor Document::accessor(std::int64_t number, std::size_t components, const char* what) {
  constexpr std::array<const char*, 5> kTypes{"", "SCALAR", "VEC2", "VEC3", "VEC4"};
  const std::string where = "accessors[" + std::to_string(number) + "]";
  const Json& entry = item("accessors", number, where);
  const Json* type = find(entry, "type");
  if (type == nullptr || *type != kTypes[components]) {
    refuse(where + ".type", "must be " + std::string(kTypes[components]) + " for " + what);
  }
  if (find(entry, "sparse") != nullptr) refuse(where, std::string("is sparse, which is not read of ") + what);
  Accessor result;
  result.components = components;
  result.count = integer(entry, "count", 0, where);
  result.type = integer(entry, "componentType", -1, where);
  const Json* normalised = find(entry, "normalized");
  result.normalised = normalised != nullptr && normalised->is_boolean() && normalised->get<bool>();
  locate(entry, where, result);
  return result;
}

int Document::components(const Json& accessor, const std::string& where) const {
  constexpr std::array<const char*, 4> kTypes{"SCALAR", "VEC2", "VEC3", "VEC4"};
  const Json* type = find(accessor, "type");
  const auto* const found =
      std::ranges::find_if(kTypes, [&](const char* name) { return type != nullptr && *type == name; });
  if (found == kTypes.end()) refuse(where + ".type", "must be SCALAR, VEC2, VEC3 or VEC4");
  return static_cast<int>(found - kTypes.begin()) + 1;
}

std::string_view Document::view(std::int64_t number, const std::string& user) {
  const std::string where = "bufferViews[" + std::to_string(number) + "]";
  const Json& view = item("bufferViews", number, user);
  const Json* extensions = find(view, "extensions");
  if (extensions != nullptr && (find(*extensions, "EXT_meshopt_compression") != nullptr ||
                                find(*extensions, "KHR_meshopt_compression") != nullptr)) {
    refuse(where, "is compressed (EXT_meshopt_compression), which is not read: export it uncompressed");
  }
  const std::string_view bytes = buffer(integer(view, "buffer", -1, where), where);
  const auto offset = static_cast<std::size_t>(integer(view, "byteOffset", 0, where));
  const auto length = static_cast<std::size_t>(integer(view, "byteLength", 0, where));
  if (offset > bytes.size() || length > bytes.size() - offset) refuse(where, "reaches beyond its buffer");
  return bytes.substr(offset, length);
}

// Where the numbers are that an entry with a bufferView names. Their count, type and components are known.
void Document::locate(const Json& entry, const std::string& where, Accessor& result) {
  result.size = component_size(result.type);
  if (result.size == 0) refuse(where + ".componentType", "is " + std::to_string(result.type) + ": unknown");
  const std::int64_t number = integer(entry, "bufferView", -1, where);
  if (number < 0) refuse(where, "has no bufferView");
  const std::string_view bytes = view(number, where);
  const std::string view_where = "bufferViews[" + std::to_string(number) + "]";
  const auto inner = static_cast<std::size_t>(integer(entry, "byteOffset", 0, where));
  const std::size_t row = result.components * result.size;
  result.stride = static_cast<std::size_t>(
      integer(item("bufferViews", number, where), "byteStride", static_cast<std::int64_t>(row), view_where));
  if (result.stride < row || result.stride > 4096) refuse(view_where + ".byteStride", "does not fit its data");
  const auto rows = static_cast<std::size_t>(result.count);
  if (rows > 0 &&
      (inner > bytes.size() || row > bytes.size() - inner || rows - 1 > (bytes.size() - inner - row) / result.stride)) {
    refuse(where, "reaches beyond its bufferView: " + std::to_string(result.count) + " entries are announced");
  }
  result.data = bytes.data() + (rows > 0 ? inner : 0);
}

Document::Rows Document::filled(std::int64_t number, std::size_t alignment) {
  const std::string where = "accessors[" + std::to_string(number) + "]";
  const Json& entry = item("accessors", number, where);
  Accessor base;
  base.components = static_cast<std::size_t>(components(entry, where));
  base.count = integer(entry, "count", 0, where);
  base.type = integer(entry, "componentType", -1, where);
  locate(entry, where, base);

  const std::string at = where + ".sparse";
  const Json& sparse = entry.at("sparse");
  const Json* indices = find(sparse, "indices");
  const Json* values = find(sparse, "values");
  if (indices == nullptr || values == nullptr) refuse(at, "needs indices and values");
  Accessor places;
  places.components = 1;
  places.count = integer(sparse, "count", 0, at);
  places.type = integer(*indices, "componentType", -1, at + ".indices");
  if (places.type != kUnsignedByte && places.type != kUnsignedShort && places.type != kUnsignedInt) {
    refuse(at + ".indices.componentType", "is " + std::to_string(places.type) + ": indices must be unsigned");
  }
  locate(*indices, at + ".indices", places);
  Accessor changed = base;
  changed.count = places.count;
  locate(*values, at + ".values", changed);

  Rows rows;
  const std::size_t row = base.components * base.size;
  rows.stride = (row + alignment - 1) / alignment * alignment;
  rows.bytes.resize(static_cast<std::size_t>(base.count) * rows.stride);
  for (std::size_t r = 0; r < static_cast<std::size_t>(base.count); ++r) {
    std::copy_n(base.data + r * base.stride, row, rows.bytes.data() + r * rows.stride);
  }
  for (std::int64_t i = 0; i < places.count; ++i) {
    const double place = places.value(i, 0);
    if (place >= static_cast<double>(base.count)) {
      refuse(at + ".indices", "entry " + std::to_string(static_cast<std::int64_t>(place)) +
                                  " is changed, but there are " + std::to_string(base.count));
    }
    std::copy_n(changed.data + static_cast<std::size_t>(i) * changed.stride, row,
                rows.bytes.data() + static_cast<std::size_t>(place) * rows.stride);
  }
  return rows;
}

std::string_view Document::buffer(std::int64_t number, const std::string& user) {
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
    auto decoded = comma == std::string::npos ? std::nullopt : decode_base64(std::string_view(text).substr(comma + 8));
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

}  // namespace orbifit::gltf

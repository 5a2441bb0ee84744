#include "files/gltf_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "orbifit/model/errors.h"

#include "files/binary.h"
#include "files/file.h"
#include "files/gltf.h"

namespace orbifit {

using namespace gltf;

namespace {

using Json = GltfFile::Json;

constexpr std::size_t kMaxStride = 4096;  // bytes; glTF's own limit is 252
constexpr std::size_t kHeader = 12;       // of a GLB, bytes
constexpr std::size_t kChunkHeader = 8;   // bytes
constexpr std::string_view kDataUri = "data:application/octet-stream;base64,";

std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    const std::size_t held = std::min<std::size_t>(3, bytes.size() - i);
    for (std::size_t k = 0; k < 3; ++k) {
      bits = (bits << 8U) | (k < held ? static_cast<std::uint8_t>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text += k <= held ? kDigits[(bits >> (18U - 6U * static_cast<unsigned>(k))) & 63U] : '=';
    }
  }
  return text;
}

void store_float(std::string& bytes, std::size_t offset, float number) {
  std::string text;
  store(text, number);
  bytes.replace(offset, text.size(), text);
}

bool whole(const Json& object, const char* key, bool needed) {
  const Json* found = GltfFile::find(object, key);
  return found == nullptr ? !needed
                          : found->is_number_integer() && found->get<double>() >= 0 && found->get<double>() < 9e15;
}

void pad(std::string& bytes, char with) {
  bytes.resize((bytes.size() + 3) / 4 * 4, with);
}

}  // namespace

GltfFile::GltfFile(std::filesystem::path file, std::string_view content) : file_(std::move(file)) {
  binary_ = content.size() >= kHeader && load<std::uint32_t>(content.data()) == kMagic;
  std::string_view text = content;
  std::string_view bin;
  if (binary_) {
    std::size_t at = kHeader;
    const auto chunk = [&] {
      const std::size_t length = load<std::uint32_t>(content.data() + at);
      const std::string_view result = content.substr(at + kChunkHeader, length);
      at = std::min(content.size(), at + kChunkHeader + length);
      return result;
    };
    text = chunk();
    if (at + kChunkHeader <= content.size() && load<std::uint32_t>(content.data() + at + 4) == kBinChunk) bin = chunk();
    further_chunks_ = content.substr(at);
  }
  root_ = Json::parse(text);
  const std::size_t count = root_.contains("buffers") ? root_["buffers"].size() : 0;
  buffers_.resize(count);
  changed_.resize(count);
  if (binary_ && count > 0 && !root_["buffers"][0].contains("uri")) {
    buffers_[0] = bin.substr(0, root_["buffers"][0].value("byteLength", bin.size()));
    own_buffer_ = 0;
  }
}

const std::string& GltfFile::buffer(std::int64_t number) {
  std::string& bytes = buffers_[static_cast<std::size_t>(number)];
  const Json& entry = root_["buffers"][static_cast<std::size_t>(number)];
  if (!bytes.empty() || !entry.contains("uri")) return bytes;
  const auto& uri = entry["uri"].get_ref<const std::string&>();
  if (uri.starts_with("data:")) {
    bytes = decode_base64(std::string_view(uri).substr(uri.find(',') + 1)).value_or("");
  } else {
    bytes = read_file(file_.parent_path() / decode_percent(uri));
  }
  return bytes;
}

const Json* GltfFile::find(const Json& object, const char* key) {
  if (!object.is_object()) return nullptr;
  const auto found = object.find(key);
  return found == object.end() ? nullptr : &*found;
}

void GltfFile::refuse(const std::string& where, const std::string& reason) const {
  throw InputError(file_.string(), where, reason);
}

const Json& GltfFile::entry(const char* list, const Json& number, const std::string& user) const {
  const Json* all = find(root_, list);
  const std::size_t size = all != nullptr && all->is_array() ? all->size() : 0;
  if (!number.is_number_integer() || number.get<double>() < 0 || number.get<double>() >= static_cast<double>(size)) {
    refuse(user, "names an entry of " + std::string(list) + " that there is not");
  }
  const Json& result = (*all)[number.get<std::size_t>()];
  if (!result.is_object()) refuse(std::string(list) + "[" + number.dump() + "]", "must be an object");
  return result;
}

GltfFile::Place GltfFile::place(std::int64_t accessor, int components) const {
  const Json& entry = root_["accessors"][static_cast<std::size_t>(accessor)];
  const Json& view = root_["bufferViews"][entry["bufferView"].get<std::size_t>()];
  const Json* normalised = find(entry, "normalized");
  Place result;
  result.buffer = view["buffer"].get<std::int64_t>();
  result.offset = view.value("byteOffset", std::size_t{0}) + entry.value("byteOffset", std::size_t{0});
  result.type = entry["componentType"].get<std::int64_t>();
  result.normalised = normalised != nullptr && normalised->is_boolean() && normalised->get<bool>();
  result.count = entry["count"].get<std::size_t>();
  result.stride = view.value("byteStride", static_cast<std::size_t>(components) * component_size(result.type));
  return result;
}

GltfAttribute GltfFile::attribute(const Json& number, std::int64_t count, const std::string& user) {
  const Json& accessor = entry("accessors", number, user);
  const std::string where = "accessors[" + number.dump() + "]";
  const Json* type = find(accessor, "type");
  if (type == nullptr || (*type != "VEC2" && *type != "VEC3" && *type != "VEC4")) {
    refuse(where, "is no list of vectors");
  }
  const Json* view_number = find(accessor, "bufferView");
  if (find(accessor, "sparse") != nullptr || view_number == nullptr) {
    refuse(where, "has no bufferView: only what has numbers of its own is read");
  }
  const bool good = whole(accessor, "count", true) && whole(accessor, "byteOffset", false) &&
                    whole(accessor, "componentType", true) &&
                    component_size(accessor["componentType"].get<std::int64_t>()) > 0;
  if (!good) refuse(where, "has a key that is no integer, or a component type that there is not");
  if (accessor["count"].get<std::int64_t>() != count) {
    refuse(where, "has " + accessor["count"].dump() + " rows for " + std::to_string(count) + " vertices");
  }
  const std::string_view bytes = view(*view_number, where);
  if (!whole(entry("bufferViews", *view_number, where), "byteStride", false)) {
    refuse("bufferViews[" + view_number->dump() + "].byteStride", "must be an integer");
  }
  GltfAttribute result;
  result.components = *type == "VEC4" ? 4 : *type == "VEC2" ? 2 : 3;
  const Place from = place(number.get<std::int64_t>(), result.components);
  const std::size_t inner = accessor.value("byteOffset", std::size_t{0});
  const std::size_t row = static_cast<std::size_t>(result.components) * component_size(from.type);
  if (from.stride < row || from.stride > kMaxStride) {
    refuse("bufferViews[" + view_number->dump() + "].byteStride", "does not fit its data");
  }
  if (from.count > 0 && (inner > bytes.size() || row > bytes.size() - inner ||
                         from.count - 1 > (bytes.size() - inner - row) / from.stride)) {
    refuse(where, "reaches beyond its bufferView: " + std::to_string(from.count) + " entries are announced");
  }
  result.values.reserve(from.count * static_cast<std::size_t>(result.components));
  for (std::size_t v = 0; v < from.count; ++v) {
    for (std::size_t k = 0; k < static_cast<std::size_t>(result.components); ++k) {
      const char* at = bytes.data() + inner + v * from.stride + k * component_size(from.type);
      result.values.push_back(static_cast<float>(load_component(at, from.type, from.normalised)));
    }
  }
  return result;
}

std::string_view GltfFile::view(const Json& number, const std::string& user) {
  const Json& view = entry("bufferViews", number, user);
  const std::string where = "bufferViews[" + number.dump() + "]";
  if (!whole(view, "buffer", true) || !whole(view, "byteOffset", false) || !whole(view, "byteLength", true)) {
    refuse(where, "has a key that is missing or no integer");
  }
  entry("buffers", view["buffer"], where);
  const std::string_view bytes = buffer(view["buffer"].get<std::int64_t>());
  const auto offset = view.value("byteOffset", std::size_t{0});
  const auto length = view["byteLength"].get<std::size_t>();
  if (offset > bytes.size() || length > bytes.size() - offset) refuse(where, "reaches beyond its buffer");
  return bytes.substr(offset, length);
}

std::optional<std::vector<std::int64_t>> GltfFile::corners(const Json& primitive) {
  if (!primitive.contains("indices")) return std::nullopt;
  const Place from = place(primitive["indices"].get<std::int64_t>(), 1);
  const std::string& bytes = buffer(from.buffer);
  std::vector<std::int64_t> result;
  for (std::size_t i = 0; i < from.count; ++i) {
    const char* at = bytes.data() + from.offset + i * from.stride;
    result.push_back(static_cast<std::int64_t>(load_component(at, from.type, false)));
  }
  return result;
}

bool GltfFile::writable(std::int64_t accessor) const {
  const Json& entry = root_["accessors"][static_cast<std::size_t>(accessor)];
  if (entry["componentType"] != int{kFloat}) return false;
  const auto view = entry["bufferView"].get<std::size_t>();
  const Json& buffer = root_["buffers"][root_["bufferViews"][view]["buffer"].get<std::size_t>()];
  return !buffer.contains("uri") || buffer["uri"].get_ref<const std::string&>().starts_with("data:");
}

void GltfFile::set(std::int64_t accessor, const GltfAttribute& attribute) {
  const Place to = place(accessor, attribute.components);
  buffer(to.buffer);
  std::string& bytes = buffers_[static_cast<std::size_t>(to.buffer)];
  const auto components = static_cast<std::size_t>(attribute.components);
  for (std::size_t i = 0; i < attribute.values.size(); ++i) {
    store_float(bytes, to.offset + i / components * to.stride + i % components * sizeof(float), attribute.values[i]);
  }
  changed_[static_cast<std::size_t>(to.buffer)] = true;
  set_bounds(accessor, attribute);
}

// Where the file states bounds, as it must for positions.
void GltfFile::set_bounds(std::int64_t accessor, const GltfAttribute& attribute) {
  Json& entry = root_["accessors"][static_cast<std::size_t>(accessor)];
  const auto components = static_cast<std::size_t>(attribute.components);
  std::vector<float> low(components, std::numeric_limits<float>::max());
  std::vector<float> high(components, std::numeric_limits<float>::lowest());
  for (std::size_t i = 0; i < attribute.values.size(); ++i) {
    low[i % components] = std::min(low[i % components], attribute.values[i]);
    high[i % components] = std::max(high[i % components], attribute.values[i]);
  }
  if (entry.contains("min")) entry["min"] = low;
  if (entry.contains("max")) entry["max"] = high;
}

std::int64_t GltfFile::own_buffer() {
  if (own_buffer_ >= 0) return own_buffer_;
  own_buffer_ = static_cast<std::int64_t>(buffers_.size());
  buffers_.emplace_back();
  changed_.push_back(true);
  root_["buffers"].push_back({{"byteLength", 0}, {"uri", ""}});
  return own_buffer_;
}

std::int64_t GltfFile::add_view(std::string_view added) {
  const auto number = static_cast<std::size_t>(own_buffer());
  std::string& bytes = buffers_[number];
  pad(bytes, '\0');
  const std::size_t offset = bytes.size();
  bytes += added;
  changed_[number] = true;
  root_["buffers"][number]["byteLength"] = bytes.size();
  root_["bufferViews"].push_back({{"buffer", number}, {"byteOffset", offset}, {"byteLength", added.size()}});
  return static_cast<std::int64_t>(root_["bufferViews"].size()) - 1;
}

std::int64_t GltfFile::add(std::int64_t like, const GltfAttribute& attribute) {
  std::string numbers;
  numbers.reserve(attribute.values.size() * sizeof(float));
  for (const float value : attribute.values) store(numbers, value);
  const std::int64_t view = add_view(numbers);
  Json entry = root_["accessors"][static_cast<std::size_t>(like)];
  entry["bufferView"] = view;
  entry["componentType"] = int{kFloat};
  entry.erase("byteOffset");
  entry.erase("normalized");
  root_["accessors"].push_back(entry);
  const auto result = static_cast<std::int64_t>(root_["accessors"].size()) - 1;
  set_bounds(result, attribute);
  return result;
}

std::string GltfFile::bytes() const {
  Json root = root_;
  std::string bin;
  for (std::size_t b = 0; b < buffers_.size(); ++b) {
    Json& entry = root["buffers"][b];
    if (binary_ && b == 0 && !entry.contains("uri")) {
      bin = buffers_[b];
    } else if (changed_[b]) {
      entry["uri"] = std::string(kDataUri) + base64(buffers_[b]);
    }
  }
  std::string text = root.dump();
  if (!binary_) return text;
  pad(text, ' ');
  pad(bin, '\0');
  const std::size_t total =
      kHeader + kChunkHeader + text.size() + (bin.empty() ? 0 : kChunkHeader + bin.size()) + further_chunks_.size();
  if (total > std::numeric_limits<std::uint32_t>::max()) {
    throw InputError(file_.string(), "", "the edited file would be larger than 4 GB, which GLB cannot hold");
  }
  std::string result;
  result.reserve(total);
  store(result, kMagic);
  store(result, std::uint32_t{2});
  store(result, static_cast<std::uint32_t>(total));
  const auto chunk = [&](std::uint32_t type, const std::string& data) {
    store(result, static_cast<std::uint32_t>(data.size()));
    store(result, type);
    result += data;
  };
  chunk(kJsonChunk, text);
  if (!bin.empty()) chunk(kBinChunk, bin);
  return result.append(further_chunks_);
}

}  // namespace orbifit

#include "batch/manifest.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>

#include <fnmatch.h>
#include <nlohmann/json.hpp>

#include "orbifit/model/errors.h"

#include "batch/content_hash.h"
#include "batch/item_names.h"
#include "batch/unforked.h"
#include "files/file.h"

namespace orbifit::batch {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

constexpr std::array kMeshEndings{".obj", ".off", ".ply", ".stl", ".gltf", ".glb", ".3mf"};

std::string string_of(const json& value, const char* key) {
  const auto found = value.find(key);
  if (found == value.end()) return {};
  if (!found->is_string()) throw std::invalid_argument(std::string(key) + " must be a string");
  return found->get<std::string>();
}

fs::path path_of(const std::string& text, const fs::path& folder) {
  return text.empty() ? fs::path() : folder / text;
}

std::vector<fs::path> scans_of(const json& value, const fs::path& folder) {
  std::vector<fs::path> scans;
  const std::string one = string_of(value, "scan");
  if (!one.empty()) scans.push_back(path_of(one, folder));
  const auto list = value.find("scans");
  if (list == value.end()) return scans;
  if (!list->is_array()) throw std::invalid_argument("scans must be a list of file names");
  for (const json& entry : *list) {
    if (!entry.is_string()) throw std::invalid_argument("scans must be a list of file names");
    scans.push_back(path_of(entry.get<std::string>(), folder));
  }
  return scans;
}

// Throws std::exception without the place.
Item parsed_item(const std::string& line, const fs::path& folder) {
  const json value = json::parse(line);
  if (!value.is_object()) throw std::invalid_argument("is no JSON object");
  Item item;
  item.id = string_of(value, "id");
  if (item.id.empty()) throw std::invalid_argument("has no id");
  item.mesh = path_of(string_of(value, "mesh"), folder);
  if (item.mesh.empty()) throw std::invalid_argument("has no mesh");
  item.scans = scans_of(value, folder);
  item.annotation = path_of(string_of(value, "annotation"), folder);
  if (const auto options = value.find("options"); options != value.end()) {
    if (!options->is_object()) throw std::invalid_argument("options must be a JSON object");
    for (const auto& [name, given] : options->items()) item.options.emplace_back(name, given.dump());
  }
  return item;
}

Item item_of_line(const std::string& line, const fs::path& file, std::size_t number) {
  try {
    return parsed_item(line, file.parent_path());
  } catch (const json::exception& error) {
    throw InputError(file.string(), "line " + std::to_string(number), std::string("is not JSON: ") + error.what());
  } catch (const std::invalid_argument& error) {
    throw InputError(file.string(), "line " + std::to_string(number), error.what());
  }
}

bool blank(const std::string& line) {
  return line.find_first_not_of(" \t\r") == std::string::npos;
}

// Which line has which id, to find two that have the same.
struct NumberedId {
  Hash id;
  std::size_t line;
  auto operator<=>(const NumberedId&) const = default;
};

void refuse_repeated_ids(UnforkedVector<NumberedId>& ids, const fs::path& file) {
  std::ranges::sort(ids);
  // Of all that are repeated the first that comes again.
  const NumberedId *first = nullptr, *second = nullptr;
  for (std::size_t i = 1; i < ids.size(); ++i) {
    if (ids[i].id != ids[i - 1].id || (second != nullptr && second->line < ids[i].line)) continue;
    first = &ids[i - 1];
    second = &ids[i];
  }
  if (second == nullptr) return;
  throw InputError(file.string(), "line " + std::to_string(second->line),
                   "has the id of line " + std::to_string(first->line) + "; each item needs one of its own");
}

bool is_mesh_name(const fs::path& name) {
  return std::ranges::find(kMeshEndings, lower_extension(name)) != kMeshEndings.end();
}

}  // namespace

struct Manifest::Implementation {
  fs::path source;  // the manifest or the folder
  bool folder = false;
  UnforkedVector<std::uint64_t> begins;  // of each item: of its line in the file, or of its path in `paths`
  UnforkedVector<std::uint64_t> lines;   // of each item of a file: its line's number, for messages
  UnforkedVector<char> paths;            // ended by 0 each
  mutable std::ifstream stream;
};

Manifest::Manifest(std::unique_ptr<Implementation> implementation) : implementation_(std::move(implementation)) {}
Manifest::~Manifest() = default;
Manifest::Manifest(Manifest&&) noexcept = default;
Manifest& Manifest::operator=(Manifest&&) noexcept = default;

Manifest Manifest::from_lines(const fs::path& file, const Shard& shard) {
  auto result = std::make_unique<Implementation>();
  result->source = file;
  std::error_code code;
  if (!fs::is_regular_file(file, code)) {
    throw InputError(file.string(), "", fs::exists(file, code) ? "is not a regular file" : "no such file");
  }
  std::ifstream& stream = result->stream;
  stream.open(file, std::ios::binary);
  if (!stream) throw InputError(file.string(), "", std::string("cannot be read: ") + std::strerror(errno));
  UnforkedVector<NumberedId> ids;
  std::uint64_t begin = 0;
  std::string line;
  for (std::size_t number = 1; std::getline(stream, line); ++number) {
    const std::uint64_t next = begin + line.size() + 1;
    if (!blank(line)) {
      const Item item = item_of_line(line, file, number);
      ids.push_back({hash_of(item.id), number});
      if (shard.holds(item.id)) {
        result->begins.push_back(begin);
        result->lines.push_back(number);
      }
    }
    begin = next;
  }
  if (stream.bad()) throw InputError(file.string(), "", "cannot be read to its end");
  if (ids.empty()) throw InputError(file.string(), "", "has no items");
  refuse_repeated_ids(ids, file);
  return Manifest(std::move(result));
}

Manifest Manifest::from_folder(const fs::path& folder, const std::string& glob, const Shard& shard,
                               const fs::path& without) {
  auto result = std::make_unique<Implementation>();
  result->source = folder;
  result->folder = true;
  UnforkedVector<std::uint64_t> found;
  try {
    std::error_code code;
    for (auto place = fs::recursive_directory_iterator(folder); place != fs::end(place); ++place) {
      const fs::directory_entry& entry = *place;
      if (entry.is_directory(code) && !without.empty() && fs::equivalent(entry, without, code)) {
        place.disable_recursion_pending();
        continue;
      }
      const fs::path below = entry.path().lexically_relative(folder);
      const bool fits = glob.empty() ? is_mesh_name(below) : ::fnmatch(glob.c_str(), below.c_str(), 0) == 0;
      if (!fits || entry.is_directory(code)) continue;
      found.push_back(result->paths.size());
      const std::string& text = below.native();
      result->paths.insert(result->paths.end(), text.c_str(), text.c_str() + text.size() + 1);
    }
  } catch (const fs::filesystem_error& error) {
    throw InputError(folder.string(), "", std::string("cannot be listed: ") + error.code().message());
  }
  if (found.empty()) {
    throw InputError(folder.string(), "", glob.empty() ? "holds no mesh" : "holds no file that fits '" + glob + "'");
  }
  const auto path = [&](std::uint64_t begin) { return std::string_view(result->paths.data() + begin); };
  std::ranges::sort(found, {}, path);
  std::ranges::copy_if(found, std::back_inserter(result->begins),
                       [&](std::uint64_t begin) { return shard.holds(id_of_path(path(begin))); });
  return Manifest(std::move(result));
}

std::size_t Manifest::size() const {
  return implementation_->begins.size();
}

Item Manifest::item(std::size_t number) const {
  const Implementation& own = *implementation_;
  if (own.folder) {
    const fs::path below = own.paths.data() + own.begins[number];
    Item item;
    item.id = id_of_path(below);
    item.mesh = own.source / below;
    return item;
  }
  own.stream.clear();
  own.stream.seekg(static_cast<std::streamoff>(own.begins[number]));
  std::string line;
  std::getline(own.stream, line);
  return item_of_line(line, own.source, own.lines[number]);
}

std::string manifest_line(const Item& item) {
  nlohmann::ordered_json line{{"id", item.id}, {"mesh", item.mesh.generic_string()}};
  if (!item.scans.empty()) {
    for (const fs::path& scan : item.scans) line["scans"].push_back(scan.generic_string());
  }
  if (!item.annotation.empty()) line["annotation"] = item.annotation.generic_string();
  for (const auto& [name, value] : item.options) line["options"][name] = nlohmann::ordered_json::parse(value);
  return line.dump();
}

}  // namespace orbifit::batch

#include "rewrite/companions.h"

#include <algorithm>
#include <array>
#include <system_error>

#include <nlohmann/json.hpp>

#include "orbifit/model/errors.h"

#include "files/binary.h"
#include "files/file.h"
#include "files/gltf.h"
#include "files/text.h"

namespace orbifit {

namespace fs = std::filesystem;

namespace {

void add(std::vector<std::string>& names, std::string name) {
  if (!name.empty() && std::ranges::find(names, name) == names.end()) names.push_back(std::move(name));
}

// What follows a keyword, without blanks around it: names may hold blanks.
std::string rest_of(std::string_view line, std::string_view keyword) {
  std::string_view rest = line.substr(static_cast<std::size_t>(keyword.data() - line.data()) + keyword.size());
  const std::size_t first = rest.find_first_not_of(" \t");
  if (first == std::string_view::npos) return "";
  return std::string(rest.substr(first, rest.find_last_not_of(" \t\r") - first + 1));
}

// Textures stand last in their line, behind options; of names with blanks the last word alone would be taken.
void add_textures(const fs::path& library, std::vector<std::string>& names) {
  constexpr std::array<std::string_view, 6> kMaps{"bump", "disp", "decal", "refl", "norm", "map_"};
  std::string content;
  try {
    content = read_file(library);
  } catch (const InputError&) {
    return;  // copy_companions() says that the library is missing
  }
  LineReader lines(content);
  std::string_view line;
  while (lines.next(line)) {
    WordReader words(line);
    const std::string_view keyword = words.word();
    const std::string lower = lower_case(keyword);
    if (std::ranges::none_of(kMaps, [&](std::string_view map) { return lower.starts_with(map); })) continue;
    const std::string value = rest_of(line, keyword);
    add(names, value.starts_with('-') ? value.substr(value.find_last_of(" \t") + 1) : value);
  }
}

std::vector<std::string> companions_of_obj(const fs::path& source, std::string_view content) {
  std::vector<std::string> names;
  LineReader lines(content);
  std::string_view line;
  while (lines.next(line)) {
    WordReader words(line);
    const std::string_view keyword = words.word();
    if (keyword == "mtllib") add(names, rest_of(line, keyword));
  }
  const std::vector<std::string> libraries = names;
  for (const std::string& library : libraries) {
    std::vector<std::string> textures;
    add_textures(source.parent_path() / library, textures);
    for (const std::string& texture : textures) {
      add(names, (fs::path(library).parent_path() / texture).generic_string());
    }
  }
  return names;
}

std::vector<std::string> companions_of_gltf(std::string_view content) {
  constexpr std::size_t kJsonAt = 20;  // in a GLB, behind its header and its first chunk's
  const bool binary = content.size() >= kJsonAt && load<std::uint32_t>(content.data()) == gltf::kMagic;
  const std::string_view text = binary ? content.substr(kJsonAt, load<std::uint32_t>(content.data() + 12)) : content;
  const nlohmann::json root = nlohmann::json::parse(text, nullptr, false);
  std::vector<std::string> names;
  for (const char* list : {"buffers", "images"}) {
    if (!root.is_object() || !root.contains(list) || !root[list].is_array()) continue;
    for (const nlohmann::json& entry : root[list]) {
      if (!entry.is_object() || !entry.contains("uri") || !entry["uri"].is_string()) continue;
      const auto& uri = entry["uri"].get_ref<const std::string&>();
      if (!uri.starts_with("data:") && uri.find("://") == std::string::npos) add(names, gltf::decode_percent(uri));
    }
  }
  return names;
}

bool leaves_folder(const fs::path& name) {
  return name.is_absolute() || std::ranges::any_of(name, [](const fs::path& part) { return part == ".."; });
}

}  // namespace

std::vector<std::string> companions(const fs::path& source, std::string_view content) {
  const std::string ending = lower_extension(source);
  if (ending == ".obj") return companions_of_obj(source, content);
  if (ending == ".gltf" || ending == ".glb") return companions_of_gltf(content);
  return {};
}

std::vector<std::string> copy_companions(const fs::path& file, const fs::path& source, std::string_view content) {
  std::vector<std::string> problems;
  std::error_code error;
  const fs::path from = source.parent_path();
  const fs::path to = file.parent_path();
  if (fs::equivalent(from.empty() ? "." : from, to.empty() ? "." : to, error)) return problems;
  for (const std::string& name : companions(source, content)) {
    if (leaves_folder(name)) {
      problems.push_back(in_quotes(name) + ", which " + source.string() + " names, is outside its folder: not copied");
    } else if (!fs::is_regular_file(from / name, error)) {
      problems.push_back(in_quotes(name) + ", which " + source.string() + " names, is missing");
    } else if (!fs::exists(to / name, error)) {
      fs::create_directories((to / name).parent_path(), error);
      write_file(to / name, read_file(from / name));
    }
  }
  return problems;
}

}  // namespace orbifit

#include <array>
#include <set>

#include <nlohmann/json.hpp>

#include "orbifit/model/errors.h"

#include "batch/export.h"
#include "batch/gallery_page.h"
#include "batch/item_names.h"
#include "files/file.h"

namespace orbifit::batch {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

namespace {

// RFC 3986: names of files may hold what stands for something else in an address.
std::string address_of(const fs::path& path) {
  constexpr std::string_view digits = "0123456789ABCDEF";
  constexpr std::string_view plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-._~/";
  std::string result;
  for (const char c : path.generic_string()) {
    const auto byte = static_cast<unsigned char>(c);
    if (plain.find(c) != std::string_view::npos) {
      result += c;
    } else {
      result += {'%', digits[byte >> 4], digits[byte & 15]};
    }
  }
  return result;
}

ordered_json groups_of(const ordered_json& summary) {
  ordered_json groups = ordered_json::array();
  std::set<std::string> seen;
  for (const auto& region : summary.value("regions", ordered_json::array())) {
    const std::string group = region.at("group");
    if (seen.insert(group).second) groups.push_back(group);
  }
  return groups;
}

}  // namespace

void write_gallery(const Collection& collection, const SameShapes& same, const fs::path& folder,
                   const RunContext& context) {
  std::error_code code;
  fs::create_directories(folder, code);
  if (!fs::is_directory(folder, code)) throw InputError(folder.string(), "", "is no folder and cannot be made");
  const fs::path base = fs::relative(collection.folder(), folder);
  // One array an item: the page's script names the places. A script, since pages on a disk may not load JSON.
  std::string items = "window.orbifitItems = [\n";
  for (std::size_t i = 0; i < collection.size(); ++i) {
    context.progress("gallery", static_cast<double>(i) / static_cast<double>(collection.size()));
    const Record record = collection.record(i);
    const ordered_json summary = ordered_json::parse(record.summary);
    const ordered_json mesh = summary.value("mesh", ordered_json::object());
    const fs::path picture = place_of(record.id, "+thumbnail.png"), result = place_of(record.id, ".json");
    const auto address = [&](const fs::path& place) {
      return fs::exists(collection.folder() / place) ? address_of(base / place) : std::string();
    };
    const ordered_json item{record.id,
                            to_string(record.status),
                            record.message,
                            record.seconds,
                            mesh.value("vertices", 0),
                            groups_of(summary),
                            summary.value("patterns", ordered_json::array()).size(),
                            address(picture),
                            address(result),
                            same.same_file[i],
                            same.same_shape[i]};
    items += item.dump(-1, ' ', true) + ",\n";
  }
  write_file(folder / "items.js", items + "];\n");
  write_file(folder / "index.html", kGalleryPage);
}

}  // namespace orbifit::batch

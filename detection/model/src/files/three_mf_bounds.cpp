#include "files/three_mf_bounds.h"

#ifndef ORBIFIT_PORTABLE

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <zip.h>

#include "orbifit/model/errors.h"

#include "files/file.h"
#include "files/mesh_builder.h"
#include "files/text.h"

namespace orbifit {

namespace fs = std::filesystem;

namespace {

// lib3mf compares each of the objects, components and items with all before it: some ten seconds of these.
constexpr std::int64_t kMaxElements = 30'000;

// Follows the tags of a model as its text comes in. Whether they are right is lib3mf's business.
class TagCounter {
 public:
  explicit TagCounter(const fs::path& file) : file_(file) {}

  void feed(std::string_view text) {
    while (!text.empty()) {
      const std::size_t end = text.find(open_ ? '>' : '<');
      const std::string_view part = text.substr(0, end);
      if (open_ && tag_.size() < kLongestTag) tag_ += part;
      if (end == std::string_view::npos) return;
      if (open_) count();
      tag_.clear();
      open_ = !open_;
      text.remove_prefix(end + 1);
    }
  }

 private:
  static constexpr std::size_t kLongestTag = 1 << 16;  // bytes; what is beyond is not looked at

  void count() {
    const std::string_view tag = tag_;
    std::string_view name = tag.substr(0, tag.find_first_of(" \t\r\n/"));
    name.remove_prefix(std::min(name.size(), name.find(':') + 1));  // npos + 1 is 0
    if (name == "vertex") {
      check_vertex(tag);
      if (++vertices_ > kMostVertices) refuse("more than 200 million vertices");
    }
    if (name != "object" && name != "component" && name != "item") return;
    if (++elements_ > kMaxElements) refuse("more than 30000 objects, components and items");
    if (name == "object") {
      object_ = id(tag, "id");
      parts_of_[object_] = 1;
    } else {
      const auto known = parts_of_.find(id(tag, "objectid"));
      const std::int64_t parts = known == parts_of_.end() ? 1 : known->second;
      if (name == "component") parts_of_[object_] += parts;
      parts_ += parts;
      if (parts_ > kMostThreeMfParts) refuse("components that multiply to more than a million parts");
    }
  }

  // The text of an attribute, or nothing.
  static std::optional<std::string_view> attribute(std::string_view tag, std::string_view name) {
    for (std::size_t at = tag.find(name); at != std::string_view::npos; at = tag.find(name, at + 1)) {
      const std::size_t first = tag.find_first_of("\"'", at + name.size());
      if (first == std::string_view::npos) return std::nullopt;
      const bool whole =
          at > 0 && std::string_view(" \t\r\n").find(tag[at - 1]) != std::string_view::npos &&
          tag.substr(at + name.size(), first - at - name.size()).find_first_not_of(" =") == std::string_view::npos;
      if (!whole) continue;  // a part of another name or of a text
      const std::size_t last = tag.find(tag[first], first + 1);
      return tag.substr(first + 1, last == std::string_view::npos ? last : last - first - 1);
    }
    return std::nullopt;
  }

  // An integer; -1 where there is none.
  static std::int64_t id(std::string_view tag, std::string_view name) {
    return parse_integer(attribute(tag, name).value_or("")).value_or(-1);
  }

  // lib3mf would take words for 0.
  void check_vertex(std::string_view tag) const {
    for (const char* name : {"x", "y", "z"}) {
      const auto text = attribute(tag, name);
      if (text && !parse_number(*text))
        refuse("a vertex whose " + std::string(name) + " is no number: " + in_quotes(*text));
    }
  }

  [[noreturn]] void refuse(const std::string& what) const { throw InputError(file_.string(), "", "holds " + what); }

  const fs::path& file_;
  std::string tag_;
  bool open_ = false;  // within a tag
  std::map<std::int64_t, std::int64_t> parts_of_;
  std::int64_t object_ = -1;
  std::int64_t vertices_ = 0, elements_ = 0, parts_ = 0;
};

void count_model(const fs::path& file, zip_t* archive, zip_uint64_t entry, TagCounter& counter) {
  const char* const name = zip_get_name(archive, entry, 0);
  const auto refuse = [&](const char* reason) {
    throw InputError(file.string(), name, "is damaged: " + std::string(reason));
  };
  const std::unique_ptr<zip_file_t, int (*)(zip_file_t*)> model(zip_fopen_index(archive, entry, 0), zip_fclose);
  if (model == nullptr) refuse(zip_strerror(archive));
  std::vector<char> buffer(1 << 16);
  for (;;) {
    const zip_int64_t count = zip_fread(model.get(), buffer.data(), buffer.size());
    if (count < 0) refuse(zip_file_strerror(model.get()));
    if (count <= 0) return;
    counter.feed({buffer.data(), static_cast<std::size_t>(count)});
  }
}

}  // namespace

void check_three_mf_bounds(const fs::path& file, std::string_view content) {
  zip_error_t error;
  zip_error_init(&error);
  zip_source_t* source = zip_source_buffer_create(content.data(), content.size(), 0, &error);
  const std::unique_ptr<zip_t, void (*)(zip_t*)> archive(
      source == nullptr ? nullptr : zip_open_from_source(source, ZIP_RDONLY, &error), zip_discard);
  if (archive == nullptr) {
    const std::string reason = zip_error_strerror(&error);
    if (source != nullptr) zip_source_free(source);
    zip_error_fini(&error);
    throw InputError(file.string(), "", "is no 3MF, or damaged: its zip archive cannot be opened: " + reason);
  }
  TagCounter counter(file);
  const auto count = static_cast<zip_uint64_t>(std::max<zip_int64_t>(0, zip_get_num_entries(archive.get(), 0)));
  for (zip_uint64_t entry = 0; entry < count; ++entry) {
    const char* const name = zip_get_name(archive.get(), entry, 0);
    if (name != nullptr && lower_extension(name) == ".model") count_model(file, archive.get(), entry, counter);
  }
}

}  // namespace orbifit

#endif

#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "files/gltf.h"

namespace orbifit::gltf {

/// Numbers in a buffer, all of them inside it.
struct Accessor {
  const char* data = nullptr;
  std::int64_t count = 0;
  std::size_t stride = 0;
  std::size_t size = 0;        ///< of one component
  std::size_t components = 0;  ///< of a row
  std::int64_t type = 0;
  bool normalised = false;

  double value(std::int64_t row, std::size_t component) const {
    return load_component(data + static_cast<std::size_t>(row) * stride + component * size, type, normalised);
  }
};

/// What a glTF file says, each entry checked as it is asked for, and the numbers in its buffers. An error names the
/// entry.
class Document {
 public:
  using Json = nlohmann::json;

  /// \param content  of the file, kept by reference where it is a GLB
  /// \throw InputError  as all below
  Document(const std::filesystem::path& file, std::string_view content);

  [[noreturn]] void refuse(const std::string& where, const std::string& reason) const;

  const Json& root() const { return root_; }
  /// An object's entry, or null.
  static const Json* find(const Json& object, const char* key);
  /// A list at the top level, or null.
  const Json* list(const char* key) const;
  /// An object in a list at the top level. \param user  what names it
  const Json& item(const char* key, std::int64_t index, const std::string& user) const;
  /// An integer, at least 0.
  std::int64_t integer(const Json& object, const char* key, std::int64_t otherwise, const std::string& where) const;
  /// Numbers of nodes that there are.
  std::vector<std::int64_t> node_list(const Json& object, const char* key, const std::string& where) const;

  /// \return whether the entry is there
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

  /// \param what  its numbers are, for messages
  Accessor accessor(std::int64_t number, std::size_t components, const char* what);
  /// Numbers of a row of an accessor that holds scalars or vectors.
  int components(const Json& accessor, const std::string& where) const;
  /// The bytes of a buffer view.
  std::string_view view(std::int64_t number, const std::string& user);

  struct Rows {
    std::string bytes;
    std::size_t stride = 0;  ///< from row to row
  };
  /// All numbers of a sparse accessor. \param alignment  of rows, in bytes
  Rows filled(std::int64_t number, std::size_t alignment);

 private:
  std::string_view split(std::string_view content);
  std::string_view buffer(std::int64_t number, const std::string& user);
  void locate(const Json& entry, const std::string& where, Accessor& result);

  std::filesystem::path file_;
  Json root_;
  std::string_view binary_chunk_;
  std::map<std::int64_t, std::string> buffers_;
};

}  // namespace orbifit::gltf

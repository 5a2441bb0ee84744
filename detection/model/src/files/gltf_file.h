#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

namespace orbifit {

/// Rows of numbers that an attribute of a glTF file holds.
struct GltfAttribute {
  int components = 3;
  std::vector<float> values;  ///< row by row
};

/// A glTF or GLB file whose attributes can be changed; all that is not touched stays, in its order.
/// \pre the file was read by read_gltf(): its JSON, positions and indices are right
class GltfFile {
 public:
  using Json = nlohmann::ordered_json;

  /// \param content outlives this
  GltfFile(std::filesystem::path file, std::string_view content);

  /// An object's entry, or null.
  static const Json* find(const Json& object, const char* key);
  /// An entry of a list at the top level, an object. \throw InputError where there is none
  const Json& entry(const char* list, const Json& number, const std::string& user) const;

  Json& root() { return root_; }

  /// The rows of an attribute. \param number  of its accessor \param user  what names it
  /// \throw InputError where there is no such accessor, it has other than `count` rows, or these are not in its buffer
  GltfAttribute attribute(const Json& number, std::int64_t count, const std::string& user);

  /// The bytes of a buffer view, such as an image. \throw InputError
  std::string_view view(const Json& number, const std::string& user);

  /// Corners of a primitive, or nothing where its vertices follow one another.
  std::optional<std::vector<std::int64_t>> corners(const Json& primitive);

  /// Whether the accessor's numbers can be changed where they are: in single precision, within the file.
  bool writable(std::int64_t accessor) const;
  /// Changes numbers in place. \pre writable(accessor)
  void set(std::int64_t accessor, const GltfAttribute& attribute);
  /// Adds numbers at the file's end. \return the new accessor, which is as `like` but for where its numbers are
  std::int64_t add(std::int64_t like, const GltfAttribute& attribute);
  /// Adds bytes at the file's end. \return the new buffer view
  std::int64_t add_view(std::string_view bytes);

  std::string bytes() const;

 private:
  struct Place {
    std::int64_t buffer = 0;
    std::size_t offset = 0, stride = 0, count = 0;
    std::int64_t type = 0;
    bool normalised = false;
  };

  Place place(std::int64_t accessor, int components) const;
  [[noreturn]] void refuse(const std::string& where, const std::string& reason) const;
  const std::string& buffer(std::int64_t number);
  void set_bounds(std::int64_t accessor, const GltfAttribute& attribute);
  std::int64_t own_buffer();

  std::filesystem::path file_;
  bool binary_ = false;
  Json root_;
  std::string_view further_chunks_;   // of a GLB, behind its BIN
  std::vector<std::string> buffers_;  // empty: not loaded yet
  std::vector<bool> changed_;         // of the buffers
  std::int64_t own_buffer_ = -1;      // where numbers are added
};

}  // namespace orbifit

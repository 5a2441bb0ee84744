#pragma once

#include <bit>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace orbifit {

enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::float32;
  std::optional<PlyType> count_type;  ///< of a list
};

struct PlyElement {
  std::string name;
  long long count = 0;
  std::vector<PlyProperty> properties;

  /// Position of a property, or -1.
  int find(std::string_view property) const;
};

enum class PlyEncoding { ascii, little, big };

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::ascii;
  std::vector<PlyElement> elements;
  std::size_t size = 0;  ///< bytes up to the body
};

/// Bytes that a number takes in a binary file.
std::size_t size_of(PlyType type);

/// The number stored at `bytes`. \pre size_of(type) bytes are there
double ply_number(const char* bytes, PlyType type, std::endian order);

/// \throw InputError naming `file`
PlyHeader read_ply_header(const std::string& file, std::string_view content);

/// One row of an element; every number of a PLY fits a double.
struct PlyRow {
  long long number = 0;
  long long line = 0;                      ///< 0 in a binary file
  std::vector<double> values;              ///< one a property; unused for a list
  std::vector<std::vector<double>> lists;  ///< one a property; empty for a scalar
};

/// Calls `visit` with every row of the file's elements, in order. The row lives until the next call.
/// \throw InputError naming `file`
void visit_ply(const std::string& file, std::string_view content,
               const std::function<void(const PlyElement& element)>& begin_element,
               const std::function<void(const PlyElement& element, const PlyRow& row)>& visit);

}  // namespace orbifit

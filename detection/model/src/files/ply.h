#pragma once

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

#pragma once

#include <cstddef>
#include <string_view>

namespace orbifit::stl {

inline constexpr std::size_t kHeader = 84;    ///< 80 bytes of anything, then the number of triangles
inline constexpr std::size_t kTriangle = 50;  ///< normal and three corners in single precision, two bytes of attributes

/// Whether the file is of the kind that is written as text. Binary files may begin with "solid" too: their size
/// decides.
bool is_text(std::string_view content);

}  // namespace orbifit::stl

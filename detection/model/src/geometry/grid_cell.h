#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace orbifit {

/// The number of the cell of a grid in which a coordinate lies, given in widths of a cell. So far away that the number
/// is no integer of 64 bits, where a double tells no two cells apart, it is the last one there; for NaN the first.
inline std::int64_t grid_cell(double coordinate) {
  constexpr double kFarthest = 0x1p62;  // leaves room for the neighbours of the last cells
  if (!(coordinate > -kFarthest)) return static_cast<std::int64_t>(-kFarthest);
  return static_cast<std::int64_t>(std::floor(std::min(coordinate, kFarthest)));
}

/// Those of a point, or of a row with three coordinates. \param width of a cell, in the point's unit
template <class Point>
std::array<std::int64_t, 3> grid_cell(const Point& point, double width) {
  return {grid_cell(point[0] / width), grid_cell(point[1] / width), grid_cell(point[2] / width)};
}

/// Of a few whole numbers, such as those of a cell: each is mixed in by Fibonacci hashing (Knuth 1998, section 6.4).
struct CellHash {
  template <class Numbers>
  std::size_t operator()(const Numbers& numbers) const {
    std::uint64_t hash = 0;
    for (const auto number : numbers) {
      hash = (hash ^ static_cast<std::uint64_t>(number)) * 0x9e3779b97f4a7c15ULL;
      hash ^= hash >> 31U;
    }
    return static_cast<std::size_t>(hash);
  }
};

}  // namespace orbifit

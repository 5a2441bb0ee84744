#include "geometry/space_order.h"

#include <algorithm>
#include <cstdint>
#include <utility>

namespace orbifit {

namespace {

// The lowest 21 bits of x, with two zeros after each.
std::uint64_t spread_bits(std::uint64_t x) {
  x = (x | x << 32U) & 0x1F00000000FFFFULL;
  x = (x | x << 16U) & 0x1F0000FF0000FFULL;
  x = (x | x << 8U) & 0x100F00F00F00F00FULL;
  x = (x | x << 4U) & 0x10C30C30C30C30C3ULL;
  return (x | x << 2U) & 0x1249249249249249ULL;
}

// Of one coordinate; 0 where it is not a number.
std::uint64_t cell(double unit) {
  constexpr double kCells = (1 << 16) - 1;
  return unit > 0 ? static_cast<std::uint64_t>(std::min(unit, 1.0) * kCells) : 0;
}

}  // namespace

std::vector<int> space_order(const Points& points) {
  std::vector<int> result;
  if (points.rows() == 0) return result;
  const Eigen::RowVector3d low = points.colwise().minCoeff();
  const double size = std::max(1e-300, (points.colwise().maxCoeff() - low).maxCoeff());
  std::vector<std::pair<std::uint64_t, int>> order;
  order.reserve(static_cast<std::size_t>(points.rows()));
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const Eigen::RowVector3d unit = (points.row(i) - low) / size;
    order.emplace_back(
        spread_bits(cell(unit.x())) | spread_bits(cell(unit.y())) << 1U | spread_bits(cell(unit.z())) << 2U,
        static_cast<int>(i));
  }
  std::ranges::sort(order);
  result.reserve(order.size());
  for (const auto& [position, number] : order) result.push_back(number);
  return result;
}

}  // namespace orbifit

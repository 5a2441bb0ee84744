#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

namespace orbifit {

/// Orders sides of faces by their first, then their second end; those with the same ends stay in the order in which
/// they are. By counting (Seward 1954): O(sides + points).
/// \param points  more than the number of any end
/// \param ends  of a side, as an array of two
template <class Side, class Ends>
void sort_by_ends(std::vector<Side>& sides, std::size_t points, const Ends& ends) {
  std::vector<Side> ordered(sides.size());
  std::vector<std::size_t> next(points + 1);
  for (const std::size_t end : {1, 0}) {
    const auto point = [&](const Side& side) { return static_cast<std::size_t>(std::invoke(ends, side)[end]); };
    next.assign(points + 1, 0);
    for (const Side& side : sides) ++next[point(side) + 1];
    for (std::size_t k = 0; k < points; ++k) next[k + 1] += next[k];
    for (const Side& side : sides) ordered[next[point(side)]++] = side;
    std::swap(sides, ordered);
  }
}

}  // namespace orbifit

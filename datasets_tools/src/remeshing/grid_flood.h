#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace orbifit {

/// Makes the voids of a grid solid: outer nodes (0) that no way over neighbouring outer nodes leads to from the first
/// node, which is outside, become inner ones (1).
/// \param[in,out] inside of each node, the first axis fastest
void fill_voids(std::vector<std::uint8_t>& inside, const std::array<int, 3>& nodes);

/// Makes pieces of fewer than `least` inner nodes that are neighbours along the axes outer ones.
void drop_crumbs(std::vector<std::uint8_t>& inside, const std::array<int, 3>& nodes, std::size_t least);

}  // namespace orbifit

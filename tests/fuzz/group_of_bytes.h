#pragma once

#include <cstdint>
#include <span>

namespace orbifit {

/// Makes orthogonal matrices of the bytes, closes them under products, and asks for the group that they form.
/// \throw std::logic_error where a closed set is no group, or the group found is another than the set's
void classify_group_of_bytes(std::span<const std::uint8_t> bytes);

}  // namespace orbifit

#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstring>
#include <string>
#include <string_view>

namespace orbifit {

/// Number stored at `bytes` in the given byte order. \pre sizeof(Number) bytes are there
template <typename Number>
Number load(const char* bytes, std::endian order = std::endian::little) {
  std::array<char, sizeof(Number)> buffer;
  std::memcpy(buffer.data(), bytes, sizeof(Number));
  if (order != std::endian::native) std::ranges::reverse(buffer);
  return std::bit_cast<Number>(buffer);
}

/// Appends a number, little endian.
template <typename Number>
void store(std::string& bytes, Number number) {
  auto buffer = std::bit_cast<std::array<char, sizeof(Number)>>(number);
  if constexpr (std::endian::native == std::endian::big) std::ranges::reverse(buffer);
  bytes.append(buffer.data(), buffer.size());
}

}  // namespace orbifit

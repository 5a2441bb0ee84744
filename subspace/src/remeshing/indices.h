#pragma once

#include <cstddef>

namespace orbifit {

/// A number that is known not to be negative, as an index.
constexpr std::size_t at(int number) {
  return static_cast<std::size_t>(number);
}

}  // namespace orbifit

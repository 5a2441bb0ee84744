#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace orbifit {

/// Choices and numbers from a fuzzer's bytes; zeros once they are used up, so that any bytes say something.
class ByteSource {
 public:
  explicit ByteSource(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  int byte() { return at_ < bytes_.size() ? bytes_[at_++] : 0; }
  /// From 0 to count - 1. \pre 0 < count <= 256
  int below(int count) { return byte() % count; }
  bool flag() { return byte() % 2 == 1; }
  /// A coordinate in [-1, 1): mostly a multiple of a quarter, so that special places come up.
  double coordinate() {
    const int value = byte();
    return value % 2 == 0 ? (value / 2 % 8 - 4) / 4.0 : (value * 256 + byte() - 32768) / 32768.0;
  }

 private:
  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
};

}  // namespace orbifit

#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

namespace orbifit {

/// 128 bits that tell sequences of numbers apart: two of them agree by chance once in 1e38. Not against malice.
struct Digest {
  std::uint64_t low = 0x243F6A8885A308D3U, high = 0x13198A2E03707344U;

  friend bool operator==(const Digest&, const Digest&) = default;

  Digest& add(std::uint64_t number) {
    low = mixed(low ^ number);
    high = mixed(high + number * 0x9E3779B97F4A7C15U + 1);
    return *this;
  }
  Digest& add(double number) { return add(std::bit_cast<std::uint64_t>(number)); }
  Digest& add(const Digest& other) { return add(other.low).add(other.high); }
  Digest& add(std::span<const int> numbers) {
    add(static_cast<std::uint64_t>(numbers.size()));
    for (const int number : numbers) add(static_cast<std::uint64_t>(number));
    return *this;
  }

  struct Hash {
    std::size_t operator()(const Digest& digest) const { return static_cast<std::size_t>(digest.low); }
  };

 private:
  // A step of SplitMix64 (Steele, Lea, Flood 2014): a bijection in which each bit depends on all.
  static std::uint64_t mixed(std::uint64_t z) {
    z += 0x9E3779B97F4A7C15U;
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9U;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBU;
    return z ^ (z >> 31U);
  }
};

}  // namespace orbifit

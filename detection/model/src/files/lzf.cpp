#include "files/lzf.h"

namespace orbifit {

std::optional<std::string> lzf_decompress(std::string_view input, std::size_t size) {
  // Two to three bytes give 264 at most: a larger announcement is refused before memory is asked for.
  if (size / 264 > input.size()) return std::nullopt;
  std::string output;
  output.reserve(size);
  std::size_t at = 0;
  const auto byte = [&] { return static_cast<std::size_t>(static_cast<unsigned char>(input[at++])); };
  while (at < input.size()) {
    const std::size_t control = byte();
    if (control < 32) {  // a run of literal bytes
      const std::size_t length = control + 1;
      if (length > input.size() - at || length > size - output.size()) return std::nullopt;
      output.append(input.substr(at, length));
      at += length;
      continue;
    }
    std::size_t length = control >> 5U;  // a copy of what came before
    if (length == 7) {
      if (at >= input.size()) return std::nullopt;
      length += byte();
    }
    if (at >= input.size()) return std::nullopt;
    const std::size_t distance = ((control & 31U) << 8U) + byte() + 1;
    length += 2;
    if (distance > output.size() || length > size - output.size()) return std::nullopt;
    for (std::size_t i = 0; i < length; ++i) output.push_back(output[output.size() - distance]);
  }
  if (output.size() != size) return std::nullopt;
  return output;
}

}  // namespace orbifit

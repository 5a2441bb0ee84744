#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace orbifit {

/// A grey PNG without compression. \param bits  8 or 16 \param values  row by row from the top
inline std::string grey_png(int width, int height, int bits, const std::vector<int>& values) {
  const auto number = [](std::uint32_t value) {
    std::string bytes;
    for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> static_cast<unsigned>(shift));
    return bytes;
  };
  const auto chunk = [&](const std::string& body) {  // type and data
    std::uint32_t crc = 0xffffffffU;
    for (const char each : body) {
      crc ^= static_cast<unsigned char>(each);
      for (int k = 0; k < 8; ++k) crc = (crc & 1U) != 0 ? 0xedb88320U ^ (crc >> 1U) : crc >> 1U;
    }
    return number(static_cast<std::uint32_t>(body.size() - 4)) + body + number(~crc);
  };
  std::string rows;
  for (int y = 0; y < height; ++y) {
    rows += '\0';  // no filter
    for (int x = 0; x < width; ++x) {
      const auto value = static_cast<unsigned>(values[static_cast<std::size_t>(y * width + x)]);
      if (bits == 16) rows += static_cast<char>(value >> 8U);
      rows += static_cast<char>(value & 0xffU);
    }
  }
  std::uint32_t low = 1;
  std::uint32_t high = 0;
  for (const char each : rows) {
    low = (low + static_cast<unsigned char>(each)) % 65521;
    high = (high + low) % 65521;
  }
  std::string data = "\x78\x01";
  constexpr std::size_t kBlock = 65535;
  for (std::size_t at = 0; at < rows.size(); at += kBlock) {
    const std::string block = rows.substr(at, kBlock);
    const auto size = static_cast<unsigned>(block.size());
    data += at + kBlock >= rows.size() ? '\1' : '\0';
    for (const unsigned each : {size, ~size}) {
      data += static_cast<char>(each & 0xffU);
      data += static_cast<char>((each >> 8U) & 0xffU);
    }
    data += block;
  }
  data += number(high << 16U | low);
  const std::string header = number(static_cast<std::uint32_t>(width)) + number(static_cast<std::uint32_t>(height)) +
                             static_cast<char>(bits) + std::string(4, '\0');
  return "\x89PNG\r\n\x1a\n" + chunk("IHDR" + header) + chunk("IDAT" + data) + chunk("IEND");
}

}  // namespace orbifit

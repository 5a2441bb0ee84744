#include "npz.h"

#include <array>

#include "orbifit/model/errors.h"

#include "files/binary.h"

namespace orbifit {

namespace {

constexpr std::uint16_t kVersion = 20;
constexpr std::uint32_t kFirstDay = 0x00210000;  // 1980-01-01 in a zip, so that the same arrays give the same bytes

std::uint32_t crc32(std::string_view bytes) {
  static const std::array<std::uint32_t, 256> table = [] {
    std::array<std::uint32_t, 256> result{};
    for (std::uint32_t i = 0; i < 256; ++i) {
      std::uint32_t value = i;
      for (int bit = 0; bit < 8; ++bit) value = (value >> 1U) ^ ((value & 1U) != 0 ? 0xEDB88320U : 0U);
      result[i] = value;
    }
    return result;
  }();
  std::uint32_t crc = 0xFFFFFFFFU;
  for (const char byte : bytes) crc = table[(crc ^ static_cast<unsigned char>(byte)) & 0xFFU] ^ (crc >> 8U);
  return ~crc;
}

// What a member's own header and its entry in the directory share.
std::string common_fields(const std::string& name, const std::string& content) {
  std::string bytes;
  store(bytes, kVersion);
  store(bytes, std::uint16_t{0});  // flags
  store(bytes, std::uint16_t{0});  // stored
  store(bytes, kFirstDay);
  store(bytes, crc32(content));
  store(bytes, static_cast<std::uint32_t>(content.size()));
  store(bytes, static_cast<std::uint32_t>(content.size()));
  store(bytes, static_cast<std::uint16_t>(name.size()));
  store(bytes, std::uint16_t{0});  // extra field
  return bytes;
}

}  // namespace

template <class Number>
void NpzArchive::add_array(const std::string& name, const char* type, const std::vector<std::size_t>& shape,
                           const std::vector<Number>& values) {
  std::string header = std::string("{'descr': '") + type + "', 'fortran_order': False, 'shape': (";
  for (const std::size_t size : shape) header += std::to_string(size) + ",";
  header += "), }";
  constexpr std::size_t kBefore = 10;  // magic, version, length
  header.resize((kBefore + header.size() + 1 + 63) / 64 * 64 - kBefore - 1, ' ');
  header += '\n';
  std::string content("\x93NUMPY\x01\x00", 8);
  store(content, static_cast<std::uint16_t>(header.size()));
  content += header;
  for (const Number value : values) store(content, value);
  members_.push_back({name + ".npy", std::move(content)});
}

void NpzArchive::add(const std::string& name, const std::vector<std::size_t>& shape,
                     const std::vector<std::int32_t>& values) {
  add_array(name, "<i4", shape, values);
}

void NpzArchive::add(const std::string& name, const std::vector<std::size_t>& shape,
                     const std::vector<double>& values) {
  add_array(name, "<f8", shape, values);
}

std::string NpzArchive::bytes() const {
  std::string bytes;
  std::string directory;
  for (const Member& member : members_) {
    const std::string fields = common_fields(member.name, member.content);
    store(directory, std::uint32_t{0x02014B50});
    store(directory, kVersion);
    directory += fields;
    directory.append(10, '\0');  // comment, disk, attributes
    store(directory, static_cast<std::uint32_t>(bytes.size()));
    directory += member.name;
    store(bytes, std::uint32_t{0x04034B50});
    bytes += fields;
    bytes += member.name;
    bytes += member.content;
    if (bytes.size() > 0xFFFFFFF0U) throw InputError("", "", "the arrays take more than 4 GB, more than an .npz holds");
  }
  const auto start = static_cast<std::uint32_t>(bytes.size());
  bytes += directory;
  store(bytes, std::uint32_t{0x06054B50});
  store(bytes, std::uint32_t{0});  // disks
  store(bytes, static_cast<std::uint16_t>(members_.size()));
  store(bytes, static_cast<std::uint16_t>(members_.size()));
  store(bytes, static_cast<std::uint32_t>(directory.size()));
  store(bytes, start);
  store(bytes, std::uint16_t{0});  // comment
  return bytes;
}

}  // namespace orbifit

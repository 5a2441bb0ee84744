#include "io/section_file.h"

#include <algorithm>
#include <bit>

#include "orbifit/model/errors.h"

#include "files/file.h"

namespace orbifit {

static_assert(std::endian::native == std::endian::little, "the fields are copied as they lie in memory");

namespace {

constexpr std::size_t kWord = 8;
constexpr std::size_t kFixedHeader = 32;  // magic, version, number of sections, size of the file, checksum
constexpr std::size_t kTableRow = 32;     // name, start, size, checksum
constexpr std::size_t kMaxSections = 64;
constexpr std::size_t kChecksumAt = 24;

std::uint64_t checksum_of(std::string_view bytes) {
  Checksum sum;
  sum.add(bytes.data(), bytes.size());
  return sum.value();
}

// Of the header and the table, the checksum's own place left out.
std::uint64_t header_checksum(std::string_view header) {
  Checksum sum;
  sum.add(header.data(), kChecksumAt);
  sum.add(header.data() + kFixedHeader, header.size() - kFixedHeader);
  return sum.value();
}

template <class Number>
Number number_at(std::string_view bytes, std::size_t place) {
  Number number;
  std::memcpy(&number, bytes.data() + place, sizeof number);
  return number;
}

template <class Number>
void set_number(std::string& bytes, std::size_t place, Number number) {
  std::memcpy(bytes.data() + place, &number, sizeof number);
}

}  // namespace

void Checksum::add(const void* bytes, std::size_t size) {
  const auto* at = static_cast<const char*>(bytes);
  while (size > 0) {
    std::uint64_t word = 0;
    const std::size_t part = std::min(size, kWord);
    std::memcpy(&word, at, part);
    sum_ = (sum_ ^ word) * 0x9e3779b97f4a7c15ULL;
    sum_ ^= sum_ >> 32U;
    at += part;
    size -= part;
  }
}

SectionWriter::SectionWriter(const SectionFormat& format, std::size_t sections)
    : sections_(sections), content_(kFixedHeader + sections * kTableRow, '\0') {
  std::memcpy(content_.data(), format.magic, kWord);
  set_number(content_, 8, format.version);
  set_number(content_, 12, static_cast<std::uint32_t>(sections));
}

void SectionWriter::begin(std::string_view name) {
  end();
  starts_.emplace_back(name, content_.size());
}

void SectionWriter::put(const void* bytes, std::size_t size) {
  content_.append(static_cast<const char*>(bytes), size);
  content_.append((kWord - size % kWord) % kWord, '\0');
}

// Enters the section that ends here into the table.
void SectionWriter::end() {
  if (starts_.empty()) return;
  const auto& [name, start] = starts_.back();
  const std::size_t row = kFixedHeader + (starts_.size() - 1) * kTableRow;
  std::memcpy(content_.data() + row, name.data(), std::min(name.size(), kWord));
  set_number(content_, row + 8, std::uint64_t{start});
  set_number(content_, row + 16, std::uint64_t{content_.size() - start});
  set_number(content_, row + 24, checksum_of(std::string_view(content_).substr(start)));
}

std::string SectionWriter::finish() && {
  end();
  set_number(content_, 16, std::uint64_t{content_.size()});
  const std::string_view header = std::string_view(content_).substr(0, kFixedHeader + sections_ * kTableRow);
  set_number(content_, kChecksumAt, header_checksum(header));
  return std::move(content_);
}

std::int64_t SectionReader::integer(const char* field, std::int64_t lowest, std::int64_t highest) {
  if (bytes_.size() < kWord) refuse(field, "the section ends before it");
  std::int64_t value = 0;
  take(&value, sizeof value);
  if (value < lowest || value > highest) {
    refuse(field, "is " + std::to_string(value) + "; it must be from " + std::to_string(lowest) + " to " +
                      std::to_string(highest));
  }
  return value;
}

double SectionReader::real(const char* field) {
  if (bytes_.size() < kWord) refuse(field, "the section ends before it");
  double value = 0;
  take(&value, sizeof value);
  require_finite(field, value);
  return value;
}

std::vector<int> SectionReader::numbers(const char* field, std::size_t count, int lowest, int end) {
  std::vector<int> result = array<int>(field, count);
  for (const int number : result) {
    if (number < lowest || number >= end) {
      refuse(field, "holds " + std::to_string(number) + "; all must be from " + std::to_string(lowest) + " to " +
                        std::to_string(end - 1));
    }
  }
  return result;
}

std::size_t SectionReader::claim(const char* field, std::size_t size_of_one) {
  const std::int64_t count = integer(field);
  if (count < 0 || static_cast<std::uint64_t>(count) > bytes_.size() / size_of_one) {
    refuse(field, "has " + std::to_string(count) + " numbers, but " + std::to_string(bytes_.size()) +
                      " bytes are left in the section");
  }
  return static_cast<std::size_t>(count);
}

// Sections are whole words, so the padding is there where the numbers are.
void SectionReader::take(void* bytes, std::size_t size) {
  if (size > 0) std::memcpy(bytes, bytes_.data(), size);
  bytes_.remove_prefix((size + kWord - 1) / kWord * kWord);
}

void SectionReader::end() const {
  if (!bytes_.empty()) refuse("", std::to_string(bytes_.size()) + " bytes are left over");
}

void SectionReader::refuse(const std::string& field, const std::string& reason) const {
  throw InputError(file_, section_ + (field.empty() ? "" : ", " + field), reason);
}

SectionFile::SectionFile(const std::filesystem::path& file, const SectionFormat& format)
    : name_(file.string()), content_(read_file(file)) {
  const std::string_view bytes = content_;
  const auto refuse = [&](const std::string& where, const std::string& reason) {
    throw InputError(name_, where, reason);
  };
  const std::size_t seen = std::min(bytes.size(), kWord);
  if (bytes.substr(0, seen) != std::string_view(format.magic, seen)) {
    refuse("", "is not " + std::string(format.what) + ": it does not start with " + std::string(format.magic, kWord));
  }
  if (bytes.size() < kFixedHeader) refuse("header", "the file is cut off");
  const auto version = number_at<std::uint32_t>(bytes, 8);
  if (version != format.version) {
    refuse("version",
           "is " + std::to_string(version) + "; this program reads version " + std::to_string(format.version));
  }
  const std::size_t count = number_at<std::uint32_t>(bytes, 12);
  const auto size = number_at<std::uint64_t>(bytes, 16);
  if (size != bytes.size()) {
    refuse("header", (size > bytes.size() ? "the file is cut off: it has " : "the file has ") +
                         std::to_string(bytes.size()) + " bytes instead of " + std::to_string(size));
  }
  const std::size_t header = kFixedHeader + count * kTableRow;
  if (count > kMaxSections || header > bytes.size()) refuse("header", "is damaged: too many sections");
  if (header_checksum(bytes.substr(0, header)) != number_at<std::uint64_t>(bytes, kChecksumAt)) {
    refuse("header", "is damaged: its checksum is wrong");
  }
  std::size_t next = header;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t row = kFixedHeader + i * kTableRow;
    std::string name(bytes.substr(row, kWord));
    name.resize(std::min(name.find('\0'), kWord));
    const auto start = number_at<std::uint64_t>(bytes, row + 8);
    const auto length = number_at<std::uint64_t>(bytes, row + 16);
    if (start != next || length % kWord != 0 || length > bytes.size() - next) {
      refuse(name, "does not lie where a section may");
    }
    const std::string_view content = bytes.substr(next, length);
    if (checksum_of(content) != number_at<std::uint64_t>(bytes, row + 24)) {
      refuse(name, "is damaged: its checksum is wrong");
    }
    sections_[name] = content;
    next += length;
  }
  if (next != bytes.size()) refuse("", "has bytes beyond its last section");
}

SectionReader SectionFile::section(std::string_view name) const {
  const auto found = sections_.find(name);
  if (found == sections_.end()) throw InputError(name_, std::string(name), "the section is missing");
  return {name_, std::string(name), found->second};
}

}  // namespace orbifit

#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace orbifit {

/// Mixes bytes into a 64-bit sum, eight at a time, the last padded with zeros (docs/basis-format.md). Each step is a
/// bijection of the sum so far, so no change within one word can go unseen.
class Checksum {
 public:
  void add(const void* bytes, std::size_t size);
  template <class Number>
  void add(const std::vector<Number>& numbers) {
    add(numbers.data(), numbers.size() * sizeof(Number));
  }
  std::uint64_t value() const { return sum_; }

 private:
  std::uint64_t sum_ = 0xcbf29ce484222325ULL;
};

/// A file of named sections (docs/basis-format.md): magic, version, a table with a checksum for each section, and the
/// sections, whose fields all start at multiples of eight bytes. Little-endian.
struct SectionFormat {
  char magic[9];  ///< eight letters
  std::uint32_t version;
  const char* what;  ///< "a basis", for messages
};

/// Puts such a file together in memory.
class SectionWriter {
 public:
  SectionWriter(const SectionFormat& format, std::size_t sections);

  void begin(std::string_view name);  ///< at most eight letters
  void integer(std::int64_t value) { put(&value, sizeof value); }
  void real(double value) { put(&value, sizeof value); }

  /// Their number, then the numbers, padded with zeros.
  template <class Number>
  void array(const Number* numbers, std::size_t count) {
    static_assert(std::is_arithmetic_v<Number>);
    integer(static_cast<std::int64_t>(count));
    put(numbers, count * sizeof(Number));
  }
  template <class Number>
  void array(const std::vector<Number>& numbers) {
    array(numbers.data(), numbers.size());
  }

  /// The whole file.
  std::string finish() &&;

 private:
  void put(const void* bytes, std::size_t size);
  void end();

  std::size_t sections_;
  std::string content_;
  std::vector<std::pair<std::string, std::size_t>> starts_;
};

/// Reads the fields of one section in order; every count is held against the bytes that are left, and floating-point
/// numbers must be finite.
class SectionReader {
 public:
  SectionReader(std::string file, std::string section, std::string_view bytes)
      : file_(std::move(file)), section_(std::move(section)), bytes_(bytes) {}

  /// \throw InputError unless lowest <= value <= highest
  std::int64_t integer(const char* field, std::int64_t lowest = std::numeric_limits<std::int64_t>::min(),
                       std::int64_t highest = std::numeric_limits<std::int64_t>::max());
  double real(const char* field);  ///< \throw InputError unless finite

  template <class Number>
  std::vector<Number> array(const char* field) {
    std::vector<Number> numbers(claim(field, sizeof(Number)));
    take(numbers.data(), numbers.size() * sizeof(Number));
    if constexpr (std::is_floating_point_v<Number>) {
      for (const Number number : numbers) require_finite(field, number);
    }
    return numbers;
  }

  /// \throw InputError unless there are `count` numbers
  template <class Number>
  std::vector<Number> array(const char* field, std::size_t count) {
    std::vector<Number> numbers = array<Number>(field);
    if (numbers.size() != count) {
      refuse(field, "has " + std::to_string(numbers.size()) + " numbers instead of " + std::to_string(count));
    }
    return numbers;
  }

  /// \throw InputError unless there are `count` numbers, each in [lowest, end)
  std::vector<int> numbers(const char* field, std::size_t count, int lowest, int end);

  /// Where each of `count` lists starts in one of `length` entries, and `length` last. \throw InputError otherwise
  template <class Number>
  std::vector<Number> starts(const char* field, std::size_t count, std::size_t length) {
    std::vector<Number> result = array<Number>(field, count + 1);
    bool rising = result.front() == 0 && result.back() == static_cast<Number>(length);
    for (std::size_t i = 0; i < count; ++i) rising = rising && result[i] <= result[i + 1];
    if (!rising) refuse(field, "does not rise from 0 to " + std::to_string(length));
    return result;
  }

  /// \throw InputError when bytes are left
  void end() const;

  /// \throw InputError
  [[noreturn]] void refuse(const std::string& field, const std::string& reason) const;

 private:
  void require_finite(const char* field, double number) const {
    if (!std::isfinite(number)) refuse(field, "holds a number that is not finite");
  }
  std::size_t claim(const char* field, std::size_t size_of_one);
  void take(void* bytes, std::size_t size);

  std::string file_, section_;
  std::string_view bytes_;
};

/// A file in memory whose sizes and checksums have been found right.
class SectionFile {
 public:
  /// \throw InputError when the file cannot be read, is no such file, is of another version, cut off or damaged
  SectionFile(const std::filesystem::path& file, const SectionFormat& format);

  /// \throw InputError when there is none of that name
  SectionReader section(std::string_view name) const;

 private:
  std::string name_, content_;
  std::map<std::string, std::string_view, std::less<>> sections_;
};

}  // namespace orbifit

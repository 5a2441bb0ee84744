#include "files/text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

namespace orbifit {

namespace {

constexpr std::size_t kLongest = 40;  // of a quotation

bool blank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}
bool digit(char c) {
  return c >= '0' && c <= '9';
}

// from_chars does not say whether a number out of range is too large or too small: the decimal exponent of its first
// digit that is not 0 does.
double out_of_range(std::string_view text) {
  long long exponent = 0;
  const std::size_t mark = text.find_first_of("eE");
  if (mark != std::string_view::npos) {
    std::string_view digits = text.substr(mark + 1);
    if (digits.starts_with('+')) digits.remove_prefix(1);
    const auto result = std::from_chars(digits.data(), digits.data() + digits.size(), exponent);
    if (result.ec == std::errc::result_out_of_range)
      exponent = digits.starts_with('-') ? -1'000'000'000 : 1'000'000'000;
  }
  const std::string_view mantissa = text.substr(0, mark);
  const std::size_t first = mantissa.find_first_of("123456789");
  const std::size_t point = std::min(mantissa.find('.'), mantissa.size());
  const double position = static_cast<double>(point) - static_cast<double>(first);
  const bool small = static_cast<double>(exponent) + position < 0;
  const double size = small ? 0 : std::numeric_limits<double>::infinity();
  return text.starts_with('-') ? -size : size;
}

}  // namespace

LineReader::LineReader(std::string_view text) : rest_(text) {
  if (rest_.starts_with("\xEF\xBB\xBF")) rest_.remove_prefix(3);
  if (rest_.find('\n') == std::string_view::npos) separator_ = '\r';
}

bool LineReader::next(std::string_view& line) {
  if (rest_.empty()) return false;
  const std::size_t end = rest_.find(separator_);
  line = rest_.substr(0, end);
  rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
  if (line.ends_with('\r')) line.remove_suffix(1);
  ++line_;
  return true;
}

bool LineReader::next_content(std::string_view& line, char comment) {
  while (next(line)) {
    if (comment != '\0') line = line.substr(0, line.find(comment));
    if (!std::ranges::all_of(line, blank)) return true;
  }
  return false;
}

bool WordReader::at_end() {
  std::size_t skip = 0;
  while (skip < rest_.size() && blank(rest_[skip])) ++skip;
  rest_.remove_prefix(skip);
  return rest_.empty();
}

std::string_view WordReader::word() {
  at_end();
  std::size_t length = 0;
  while (length < rest_.size() && !blank(rest_[length])) ++length;
  const std::string_view result = rest_.substr(0, length);
  rest_.remove_prefix(length);
  return result;
}

std::optional<double> WordReader::number() {
  return parse_number(word());
}
std::optional<long long> WordReader::integer() {
  return parse_integer(word());
}

std::optional<double> parse_number(std::string_view text) {
  if (text.starts_with('+') && text.size() > 1 && (digit(text[1]) || text[1] == '.')) text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end != text.data() + text.size()) return std::nullopt;
  if (error == std::errc::result_out_of_range) return out_of_range(text);
  if (error != std::errc{}) return std::nullopt;
  return value;
}

std::optional<long long> parse_integer(std::string_view text) {
  if (text.starts_with('+') && text.size() > 1 && digit(text[1])) text.remove_prefix(1);
  long long value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

void append_number(std::string& text, double number) {
  char buffer[32];
  const auto result = std::to_chars(buffer, buffer + sizeof buffer, number);
  text.append(buffer, result.ptr);
}

void append_number(std::string& text, long long number) {
  char buffer[24];
  const auto result = std::to_chars(buffer, buffer + sizeof buffer, number);
  text.append(buffer, result.ptr);
}

std::string lower_case(std::string_view text) {
  std::string result(text);
  std::ranges::transform(result, result.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; });
  return result;
}

std::string place(long long line, std::string_view element, long long number) {
  if (line > 0) return "line " + std::to_string(line);
  return std::string(element) + " " + std::to_string(number);
}

std::string in_quotes(std::string_view text) {
  std::string result(text.substr(0, kLongest));
  std::ranges::replace_if(
      result, [](char c) { return static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) > 0x7e; }, '?');
  return "'" + result + (text.size() > kLongest ? "...'" : "'");
}

}  // namespace orbifit

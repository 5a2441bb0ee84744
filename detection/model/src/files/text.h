#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace orbifit {

/// The lines of a text, numbered from 1. A line ends at "\n" or "\r\n", or at "\r" in a text that has no "\n".
/// A byte order mark before the first line is skipped.
class LineReader {
 public:
  explicit LineReader(std::string_view text);

  /// Moves to the next line; false at the end. The line comes without its end.
  bool next(std::string_view& line);
  /// Moves to the next line that holds something besides blanks once a comment from `comment` on is cut off.
  bool next_content(std::string_view& line, char comment = '\0');

  long long line() const { return line_; }  ///< number of the line that next() gave last
  std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
  char separator_ = '\n';
  long long line_ = 0;
};

/// Words and numbers of one line, separated by blanks.
class WordReader {
 public:
  explicit WordReader(std::string_view line) : rest_(line) {}

  bool at_end();
  std::string_view word();  ///< empty at the end
  /// The next word as a number, "nan" and "inf" included; nothing when it is none, or at the end.
  std::optional<double> number();
  std::optional<long long> integer();

 private:
  std::string_view rest_;
};

/// The whole text as a number, independent of the locale; too small is 0, too large infinity.
std::optional<double> parse_number(std::string_view text);
std::optional<long long> parse_integer(std::string_view text);

/// Shortest text that reads back as the same number.
void append_number(std::string& text, double number);
void append_number(std::string& text, long long number);

std::string lower_case(std::string_view text);

/// "line 12", or "vertex 7" when the line is 0 as for binary data.
std::string place(long long line, std::string_view element, long long number);

/// Text for a message: in quotes, cut to a sensible length, without control characters.
std::string in_quotes(std::string_view text);

}  // namespace orbifit

#include <algorithm>
#include <cmath>

#include "orbifit/model/errors.h"

#include "files/scan_formats.h"
#include "files/text.h"

namespace orbifit {

namespace {

// Numbers of a line; commas and semicolons separate as blanks do.
bool parse_numbers(std::string_view line, std::string& buffer, std::vector<double>& numbers) {
  buffer.assign(line);
  std::ranges::replace_if(
      buffer, [](char c) { return c == ',' || c == ';'; }, ' ');
  numbers.clear();
  WordReader words(buffer);
  while (!words.at_end()) {
    const auto number = words.number();
    if (!number) return false;
    numbers.push_back(*number);
  }
  return true;
}

[[noreturn]] void refuse(const ScanBuilder& builder, long long line, const std::string& reason) {
  throw InputError(builder.file(), place(line, "", 0), reason);
}

bool unit(const std::vector<double>& numbers) {
  return numbers.size() >= 6 && std::abs(std::hypot(numbers[3], numbers[4], numbers[5]) - 1) < 0.01;
}

void add(ScanBuilder& builder, const std::vector<double>& numbers, long long line) {
  const auto value = [&](std::size_t k) { return k < numbers.size() ? numbers[k] : 0.0; };
  builder.add({value(0), value(1), value(2)}, {value(3), value(4), value(5)}, {0, 0, 0}, line);
}

void append_row(std::string& text, const Points& points, Eigen::Index row) {
  for (int k = 0; k < 3; ++k) {
    if (k > 0) text += ' ';
    append_number(text, points(row, k));
  }
}

}  // namespace

void read_xyz(std::string_view content, ScanBuilder& builder) {
  std::string buffer;
  std::vector<double> numbers;
  std::string_view line;
  // Columns 4 to 6 may be normals or colours: normals have length 1 on every line.
  bool normals = true;
  LineReader first_pass(content);
  while (normals && first_pass.next_content(line, '#')) {
    if (parse_numbers(line, buffer, numbers) && numbers.size() > 1) normals = unit(numbers);
  }
  if (normals) builder.has_normals();
  LineReader lines(content);
  for (bool first = true; lines.next_content(line, '#'); first = false) {
    const bool good = parse_numbers(line, buffer, numbers);
    if (first && (!good || numbers.size() == 1)) continue;  // names of the columns, or the number of points
    if (!good) refuse(builder, lines.line(), in_quotes(line) + " is not a row of numbers");
    if (numbers.size() < 3) refuse(builder, lines.line(), "a point needs three coordinates");
    add(builder, numbers, lines.line());
  }
}

void read_pts(std::string_view content, ScanBuilder& builder) {
  std::string buffer;
  std::vector<double> numbers;
  LineReader lines(content);
  std::string_view line;
  // Scans may follow one another, each after its count.
  while (lines.next_content(line, '#')) {
    WordReader words(line);
    const auto count = words.integer();
    if (!count || *count < 0 || !words.at_end()) {
      refuse(builder, lines.line(), "the number of points must stand here, alone; found " + in_quotes(line));
    }
    for (long long p = 0; p < *count; ++p) {
      if (!lines.next_content(line, '#')) {
        refuse(builder, lines.line(),
               "the file ends after " + std::to_string(p) + " of " + std::to_string(*count) + " points");
      }
      if (!parse_numbers(line, buffer, numbers))
        refuse(builder, lines.line(), in_quotes(line) + " is not a row of numbers");
      if (numbers.size() < 3) refuse(builder, lines.line(), "a point needs three coordinates");
      add(builder, numbers, lines.line());
    }
  }
}

std::string xyz_text(const PointCloud& scan) {
  std::string text;
  const bool normals = scan.normals.rows() == scan.points.rows();
  for (Eigen::Index p = 0; p < scan.points.rows(); ++p) {
    append_row(text, scan.points, p);
    if (normals) append_row(text += ' ', scan.normals, p);
    text += '\n';
  }
  return text;
}

std::string pts_text(const PointCloud& scan) {
  std::string text = std::to_string(scan.points.rows()) + "\n";
  for (Eigen::Index p = 0; p < scan.points.rows(); ++p) {
    append_row(text, scan.points, p);
    text += '\n';
  }
  return text;
}

}  // namespace orbifit

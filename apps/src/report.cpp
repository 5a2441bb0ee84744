#include "orbifit/apps/report.h"

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <cstdint>
#include <sstream>
#include <string_view>
#include <utility>

#include "orbifit/model/errors.h"

#include "html_text.h"

namespace orbifit {

namespace {

constexpr const char* kStyle = R"(
:root { --ink: #1d2330; --soft: #5b6475; --line: #dfe3ea; --pale: #f6f7f9; --accent: #2f6fc2; }
* { box-sizing: border-box; }
html { -webkit-text-size-adjust: 100%; }
body { margin: 0; color: var(--ink); background: #fff;
  font: 17px/1.6 system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", Arial, sans-serif; }
main, header > div, footer { max-width: 68rem; margin: 0 auto; padding: 0 1.25rem; }
header { background: var(--pale); border-bottom: 1px solid var(--line); padding: 2.6rem 0 1.8rem; }
h1 { font-size: 2rem; line-height: 1.2; letter-spacing: -.01em; margin: 0 0 .6rem; text-wrap: balance; }
header p { max-width: 46rem; margin: .4rem 0; color: var(--soft); }
nav ol { list-style: none; display: flex; flex-wrap: wrap; gap: .35rem .5rem; margin: 1.2rem 0 0; padding: 0; }
nav a { display: block; padding: .15rem .8rem; border: 1px solid var(--line); border-radius: 1rem; background: #fff;
  color: var(--ink); font-size: .88rem; text-decoration: none; }
nav a:hover { border-color: var(--accent); color: var(--accent); }
section { padding: 2.2rem 0 .6rem; border-bottom: 1px solid var(--line); }
section:last-child { border-bottom: 0; }
h2 { font-size: 1.4rem; line-height: 1.3; margin: 0 0 .5rem; }
h2 span { color: var(--accent); font-variant-numeric: tabular-nums; margin-right: .55rem; }
section > p { max-width: 46rem; margin: 0 0 1rem; }
.pictures { display: grid; gap: 1.1rem; margin: 1.1rem 0 1.3rem;
  grid-template-columns: repeat(auto-fit, minmax(min(100%, 20rem), 1fr)); }
.pictures.one { grid-template-columns: minmax(0, 46rem); }
.pictures.many { gap: .8rem; grid-template-columns: repeat(auto-fill, minmax(min(100%, 12.5rem), 1fr)); }
.many figcaption { font-size: .8rem; overflow-wrap: anywhere; }
figure { margin: 0; border: 1px solid var(--line); border-radius: .6rem; overflow: hidden; background: #fff; }
figure img, figure svg { display: block; width: 100%; height: auto; }
figcaption { padding: .5rem .8rem .6rem; font-size: .88rem; line-height: 1.45; color: var(--soft);
  border-top: 1px solid var(--line); }
figcaption b { display: block; color: var(--ink); font-weight: 600; }
pre { font: .82rem/1.5 ui-monospace, "SFMono-Regular", Menlo, Consolas, "DejaVu Sans Mono", monospace; margin: 0 0 1rem; }
pre.command { padding: .6rem .9rem; border-radius: .4rem; background: #1d2330; color: #e9edf4; white-space: pre-wrap;
  overflow-wrap: anywhere; }
pre.command::before { content: "$ "; color: #8fa1bd; }
pre.output { overflow-x: auto; }
pre.prose { white-space: pre-wrap; overflow-wrap: anywhere; }
.printed td, .printed th { white-space: nowrap; }
.files { font-size: .88rem; }
.files a { margin-right: .9rem; }
a { color: var(--accent); }
.table { overflow-x: auto; margin: 0 0 1.3rem; }
table { border-collapse: collapse; font-size: .93rem; font-variant-numeric: tabular-nums; }
th, td { padding: .35rem 1rem .35rem 0; text-align: left; vertical-align: top; border-bottom: 1px solid var(--line); }
th { color: var(--soft); font-weight: 600; white-space: nowrap; }
.number { text-align: right; padding-left: 1rem; white-space: nowrap; }
.note { font-size: .88rem; color: var(--soft); margin: 0 0 .8rem; padding-left: .9rem; border-left: 3px solid var(--line);
  max-width: 46rem; }
footer { padding-top: 1.4rem; padding-bottom: 2.5rem; color: var(--soft); font-size: .85rem; }
@media (max-width: 40rem) { table { font-size: .84rem; } th, td { padding-right: .6rem; } .number { padding-left: .4rem; }
  body { font-size: 16px; } h1 { font-size: 1.55rem; } header { padding-top: 1.6rem; } }
@media print {
  body { font-size: 10.5pt; } header { background: none; padding-top: 0; } nav { display: none; }
  main, header > div, footer { max-width: none; padding: 0; } section { border: 0; padding-top: 1.2rem; }
  figure, tr { break-inside: avoid; } h2 { break-after: avoid; }
  .pictures { grid-template-columns: repeat(2, 1fr); } .table { overflow: visible; }
}
)";

// Paragraphs are parted by blank lines.
std::string paragraphs(const std::string& text) {
  std::string result;
  std::size_t begin = 0;
  while (begin < text.size()) {
    const std::size_t end = std::min(text.find("\n\n", begin), text.size());
    const std::string part = text.substr(begin, end - begin);
    if (part.find_first_not_of(" \n\t") != std::string::npos) result += "<p>" + escaped(part) + "</p>\n";
    begin = end + 2;
  }
  return result;
}

std::uint32_t big_endian(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8U | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

// Width and height stand at fixed places of every PNG; a page that knows them does not jump while it loads.
std::string figure(const ReportPicture& picture) {
  const std::string signature("\x89PNG\r\n\x1a\n", 8);
  if (picture.png.size() < 33 || picture.png.compare(0, 8, signature) != 0) {
    throw UsageError("the picture \"" + picture.caption + "\" is not a PNG");
  }
  std::string result = "<figure><img src=\"data:image/png;base64," + base64(picture.png) + "\" alt=\"" +
                       escaped(picture.caption) + "\" width=\"" + std::to_string(big_endian(picture.png, 16)) +
                       "\" height=\"" + std::to_string(big_endian(picture.png, 20)) + "\">";
  if (!picture.caption.empty()) {
    const std::size_t title = picture.caption.find('\n');
    result += "<figcaption>";
    if (title != std::string::npos) result += "<b>" + escaped(picture.caption.substr(0, title)) + "</b>";
    result += escaped(picture.caption.substr(title == std::string::npos ? 0 : title + 1)) + "</figcaption>";
  }
  return result + "</figure>\n";
}

bool looks_like_number(const std::string& cell) {
  const std::size_t first = cell.find_first_not_of(" +-<>=~");
  return first != std::string::npos &&
         (std::isdigit(static_cast<unsigned char>(cell[first])) != 0 || cell[first] == '.');
}

std::string html(const ReportTable& table, const std::string& kind = "table") {
  const std::size_t columns = table.headers.size();
  std::vector<bool> numeric(columns, !table.rows.empty());
  for (const std::vector<std::string>& row : table.rows) {
    if (row.size() != columns) {
      throw UsageError("a table row has " + std::to_string(row.size()) + " cells: must be " + std::to_string(columns) +
                       ", as many as headers");
    }
    for (std::size_t c = 0; c < columns; ++c) {
      if (!row[c].empty() && !looks_like_number(row[c])) numeric[c] = false;
    }
  }
  const auto cells = [&](const std::vector<std::string>& row, const std::string& tag) {
    std::string result = "<tr>";
    for (std::size_t c = 0; c < columns; ++c) {
      result.append("<").append(tag).append(numeric[c] ? " class=\"number\">" : ">");
      result.append(escaped(row[c])).append("</").append(tag).append(">");
    }
    return result + "</tr>\n";
  };
  std::string result =
      "<div class=\"" + kind + "\"><table>\n<thead>" + cells(table.headers, "th") + "</thead>\n<tbody>\n";
  for (const std::vector<std::string>& row : table.rows) result += cells(row, "td");
  return result + "</tbody></table></div>\n";
}

bool is_row(const std::string& line) {
  return line.starts_with("  ") && line.find_first_not_of(' ') != std::string::npos;
}

// Columns that the program aligned: where every line has two blanks or more, one column ends.
ReportTable table_of(const std::vector<std::string>& lines) {
  std::size_t width = 0;
  for (const std::string& line : lines) width = std::max(width, line.size());
  const auto blank = [&](std::size_t at) {
    return std::ranges::all_of(lines, [&](const std::string& line) { return at >= line.size() || line[at] == ' '; });
  };
  std::vector<std::pair<std::size_t, std::size_t>> columns;  // begin and end
  std::size_t gap = 2;
  for (std::size_t at = 0; at < width; ++at) {
    if (blank(at)) {
      ++gap;
      continue;
    }
    if (gap >= 2) columns.emplace_back(at, at);
    columns.back().second = at + 1;
    gap = 0;
  }
  ReportTable table;
  for (const std::string& line : lines) {
    std::vector<std::string> cells;
    for (const auto& [begin, end] : columns) {
      const std::string cell = begin < line.size() ? line.substr(begin, end - begin) : "";
      const std::size_t first = cell.find_first_not_of(' ');
      cells.push_back(first == std::string::npos ? "" : cell.substr(first, cell.find_last_not_of(' ') + 1 - first));
    }
    (table.headers.empty() ? table.headers : table.rows.emplace_back()) = cells;
  }
  return table;
}

// What the program printed: runs of indented lines under headers are tables.
std::string printed(const std::string& output) {
  std::vector<std::string> lines;
  std::istringstream stream(output);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  std::string result;
  for (std::size_t begin = 0, end = 0; begin < lines.size(); begin = end) {
    const bool rows = is_row(lines[begin]);
    while (end < lines.size() && is_row(lines[end]) == rows) ++end;
    const std::vector<std::string> block(lines.begin() + static_cast<std::ptrdiff_t>(begin),
                                         lines.begin() + static_cast<std::ptrdiff_t>(end));
    const ReportTable table = rows && block.size() > 1 ? table_of(block) : ReportTable{};
    if (table.headers.size() > 1 && std::ranges::none_of(table.headers, looks_like_number)) {
      result += html(table, "table printed");
      continue;
    }
    std::string text;
    for (const std::string& line : block) text += line + "\n";
    if (text.find_first_not_of(" \n") != std::string::npos) {
      result += (rows ? "<pre class=\"output\">" : "<pre class=\"output prose\">") + escaped(text) + "</pre>\n";
    }
  }
  return result;
}

// A file's name as a link holds it.
std::string url(const std::string& name) {
  constexpr const char* digits = "0123456789ABCDEF";
  std::string result;
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) != 0 || std::string_view("-._~/").find(c) != std::string_view::npos) {
      result += c;
    } else {
      result += {'%', digits[byte >> 4U], digits[byte & 15U]};
    }
  }
  return result;
}

std::string links(const std::vector<ReportLink>& files) {
  if (files.empty()) return "";
  std::string result = "<p class=\"files\">Files: ";
  for (const ReportLink& file : files) {
    result += "<a href=\"" + url(file.target) + "\">" + escaped(file.text) + "</a> ";
  }
  return result + "</p>\n";
}

std::string gallery(const std::vector<ReportPicture>& pictures) {
  constexpr std::size_t kMany = 9;  // more than a page shows large
  if (pictures.empty()) return "";
  std::string result = pictures.size() == 1       ? "<div class=\"pictures one\">\n"
                       : pictures.size() >= kMany ? "<div class=\"pictures many\">\n"
                                                  : "<div class=\"pictures\">\n";
  for (const ReportPicture& picture : pictures) result += figure(picture);
  return result + "</div>\n";
}

std::string html(const ReportSection& section, std::size_t number) {
  const std::string id = std::to_string(number);
  std::string result = "<section id=\"step-" + id + "\">\n<h2><span>" + id + "</span>" + escaped(section.title) +
                       "</h2>\n" + paragraphs(section.text);
  if (!section.command.empty()) result += "<pre class=\"command\">" + escaped(section.command) + "</pre>\n";
  result += printed(section.output) + gallery(section.pictures);
  if (!section.charts.empty()) {
    result += "<div class=\"pictures\">\n";
    for (const Chart& chart : section.charts) {
      result += "<figure>" + to_svg(chart) + "<figcaption>" + escaped(chart.title) + "</figcaption></figure>\n";
    }
    result += "</div>\n";
  }
  for (const ReportTable& table : section.tables) result += html(table);
  for (const std::string& note : section.notes) result += "<p class=\"note\">" + escaped(note) + "</p>\n";
  result += links(section.files);
  return result + "</section>\n";
}

}  // namespace

std::string base64(const std::string& bytes) {
  constexpr const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string result;
  result.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t triple = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      triple = triple << 8U | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      result += i + k > bytes.size() ? '=' : digits[triple >> (18 - 6 * k) & 63U];
    }
  }
  return result;
}

std::string to_html(const Report& report) {
  std::string page = "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n";
  page += "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n";
  page += "<title>" + escaped(report.title) + "</title>\n<style>" + kStyle + "</style>\n</head>\n<body>\n";
  page += "<header><div>\n<h1>" + escaped(report.title) + "</h1>\n" + paragraphs(report.intro);
  if (report.sections.size() > 1) {
    page += "<nav><ol>\n";
    for (std::size_t s = 0; s < report.sections.size(); ++s) {
      page +=
          "<li><a href=\"#step-" + std::to_string(s + 1) + "\">" + escaped(report.sections[s].title) + "</a></li>\n";
    }
    page += "</ol></nav>\n";
  }
  page += "</div></header>\n<main>\n";
  for (std::size_t s = 0; s < report.sections.size(); ++s) page += html(report.sections[s], s + 1);
  return page + "</main>\n<footer>Made with Orbifit.</footer>\n</body>\n</html>\n";
}

}  // namespace orbifit

#include "orbifit/apps/report.h"

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <cstdint>

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
figure { margin: 0; border: 1px solid var(--line); border-radius: .6rem; overflow: hidden; background: #fff; }
figure img, figure svg { display: block; width: 100%; height: auto; }
figcaption { padding: .5rem .8rem .6rem; font-size: .88rem; line-height: 1.45; color: var(--soft);
  border-top: 1px solid var(--line); }
.table { overflow-x: auto; margin: 0 0 1.3rem; }
table { border-collapse: collapse; font-size: .93rem; font-variant-numeric: tabular-nums; }
th, td { padding: .35rem 1rem .35rem 0; text-align: left; vertical-align: top; border-bottom: 1px solid var(--line); }
th { color: var(--soft); font-weight: 600; white-space: nowrap; }
.number { text-align: right; padding-left: 1rem; white-space: nowrap; }
.note { font-size: .88rem; color: var(--soft); margin: 0 0 .8rem; padding-left: .9rem; border-left: 3px solid var(--line);
  max-width: 46rem; }
footer { padding-top: 1.4rem; padding-bottom: 2.5rem; color: var(--soft); font-size: .85rem; }
@media (max-width: 40rem) { body { font-size: 16px; } h1 { font-size: 1.55rem; } header { padding-top: 1.6rem; } }
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
  if (!picture.caption.empty()) result += "<figcaption>" + escaped(picture.caption) + "</figcaption>";
  return result + "</figure>\n";
}

bool looks_like_number(const std::string& cell) {
  const std::size_t first = cell.find_first_not_of(" +-<>=~");
  return first != std::string::npos &&
         (std::isdigit(static_cast<unsigned char>(cell[first])) != 0 || cell[first] == '.');
}

std::string html(const ReportTable& table) {
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
  std::string result = "<div class=\"table\"><table>\n<thead>" + cells(table.headers, "th") + "</thead>\n<tbody>\n";
  for (const std::vector<std::string>& row : table.rows) result += cells(row, "td");
  return result + "</tbody></table></div>\n";
}

std::string html(const ReportSection& section, std::size_t number) {
  const std::string id = std::to_string(number);
  std::string result = "<section id=\"step-" + id + "\">\n<h2><span>" + id + "</span>" + escaped(section.title) +
                       "</h2>\n" + paragraphs(section.text);
  if (!section.pictures.empty()) {
    result += section.pictures.size() == 1 ? "<div class=\"pictures one\">\n" : "<div class=\"pictures\">\n";
    for (const ReportPicture& picture : section.pictures) result += figure(picture);
    result += "</div>\n";
  }
  if (!section.charts.empty()) {
    result += "<div class=\"pictures\">\n";
    for (const Chart& chart : section.charts) {
      result += "<figure>" + to_svg(chart) + "<figcaption>" + escaped(chart.title) + "</figcaption></figure>\n";
    }
    result += "</div>\n";
  }
  for (const ReportTable& table : section.tables) result += html(table);
  for (const std::string& note : section.notes) result += "<p class=\"note\">" + escaped(note) + "</p>\n";
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

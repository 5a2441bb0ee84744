#include <array>
#include <vector>

#include "orbifit/model/errors.h"

#include "files/mesh_formats.h"
#include "files/text.h"

namespace orbifit {

namespace {

[[noreturn]] void refuse(const MeshBuilder& builder, long long line, const std::string& reason) {
  throw InputError(builder.file(), line > 0 ? place(line, "", 0) : "", reason);
}

// What follows the keyword: ST, C, N may stand before OFF and add columns after the position, which we skip.
std::string_view strip_keyword(std::string_view line, const MeshBuilder& builder, long long number) {
  WordReader words(line);
  const std::string_view first = words.word();
  const std::size_t keyword = first.find("OFF");
  if (keyword == std::string_view::npos || keyword > 4)
    refuse(builder, number, "not an OFF file: 'OFF' must come first");
  const std::string_view prefix = first.substr(0, keyword);
  if (prefix.find_first_not_of("STCN") != std::string_view::npos) {
    refuse(builder, number, in_quotes(first) + ": only three-dimensional OFF files are read");
  }
  const std::string_view rest = line.substr(static_cast<std::size_t>(first.data() - line.data()) + keyword + 3);
  if (rest.find("BINARY") != std::string_view::npos) refuse(builder, number, "binary OFF files are not read");
  return rest;
}

void read_vertex(std::string_view line, long long number, MeshBuilder& builder) {
  WordReader words(line);
  double point[3];
  for (double& coordinate : point) {
    if (words.at_end()) refuse(builder, number, "a vertex needs three coordinates");
    const std::string_view word = words.word();
    const auto value = parse_number(word);
    if (!value) refuse(builder, number, in_quotes(word) + " is not a number");
    coordinate = *value;
  }
  builder.add_vertex(point, number);
}

void read_face(std::string_view line, long long number, std::vector<std::int64_t>& corners, MeshBuilder& builder) {
  WordReader words(line);
  const auto count = words.integer();
  if (!count || *count < 0) refuse(builder, number, "a face must begin with the number of its corners");
  corners.clear();
  for (long long k = 0; k < *count; ++k) {
    if (words.at_end()) {
      refuse(builder, number,
             "the face announces " + std::to_string(*count) + " corners but names " + std::to_string(k));
    }
    const std::string_view word = words.word();
    const auto corner = parse_integer(word);
    if (!corner) refuse(builder, number, in_quotes(word) + " is not a vertex index");
    corners.push_back(*corner);
  }
  builder.add_polygon(corners, number);
}

}  // namespace

void read_off(std::string_view content, MeshBuilder& builder) {
  LineReader lines(content);
  std::string_view line;
  if (!lines.next_content(line, '#')) refuse(builder, 0, "not an OFF file: it holds comments only");
  line = strip_keyword(line, builder, lines.line());
  if (WordReader(line).at_end() && !lines.next_content(line, '#')) refuse(builder, 0, "ends before the counts");
  WordReader words(line);
  const auto vertices = words.integer();
  const auto faces = words.integer();
  if (!vertices || !faces || *vertices < 0 || *faces < 0) {
    refuse(builder, lines.line(), "the counts of vertices and faces must be two integers, at least 0");
  }
  const auto next = [&](std::string_view what, long long index, long long count) {
    if (lines.next_content(line, '#')) return;
    refuse(builder, lines.line(),
           "the file ends after " + std::to_string(index) + " of " + std::to_string(count) + " " + std::string(what));
  };
  for (long long v = 0; v < *vertices; ++v) {
    next("vertices", v, *vertices);
    read_vertex(line, lines.line(), builder);
  }
  std::vector<std::int64_t> corners;
  for (long long f = 0; f < *faces; ++f) {
    next("faces", f, *faces);
    read_face(line, lines.line(), corners, builder);
  }
  if (lines.next_content(line, '#')) {
    refuse(builder, lines.line(),
           "more lines than the header counts (" + std::to_string(*vertices) + " vertices, " + std::to_string(*faces) +
               " faces)");
  }
}

std::string off_text(const Mesh& mesh) {
  const auto ranges = polygon_ranges(mesh);
  std::string text = "OFF\n" + std::to_string(mesh.vertices.rows()) + " " + std::to_string(ranges.size()) + " 0\n";
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
    for (int k = 0; k < 3; ++k) {
      append_number(text, mesh.vertices(v, k));
      text += k < 2 ? ' ' : '\n';
    }
  }
  std::vector<int> corners;
  for (const PolygonRange& range : ranges) {
    polygon_corners(mesh, range, corners);
    append_number(text, static_cast<long long>(corners.size()));
    for (const int corner : corners) {
      text += ' ';
      append_number(text, static_cast<long long>(corner));
    }
    text += '\n';
  }
  return text;
}

}  // namespace orbifit

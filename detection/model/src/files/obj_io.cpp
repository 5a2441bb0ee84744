#include <vector>

#include "orbifit/model/errors.h"

#include "files/mesh_formats.h"
#include "files/text.h"

namespace orbifit {

namespace {

// A backslash at a line's end joins it to the next one. Blank at the end all the same counts as such.
bool continued(std::string_view line) {
  const std::size_t last = line.find_last_not_of(" \t");
  return last != std::string_view::npos && line[last] == '\\';
}

// One corner of a face: "v", "v/vt", "v//vn" or "v/vt/vn"; v counts from 1, or backwards from the last vertex if
// negative.
std::int64_t parse_corner(std::string_view word, const MeshBuilder& builder, long long line) {
  const auto number = parse_integer(word.substr(0, word.find('/')));
  const auto refuse = [&](const std::string& reason) {
    throw InputError(builder.file(), place(line, "", 0), in_quotes(word) + reason);
  };
  if (!number) refuse(" is not a corner of a face: an integer is needed");
  if (*number == 0) refuse(" names vertex 0: vertices count from 1");
  if (*number > 0) return *number - 1;
  if (*number < -builder.vertices()) {
    refuse(" is out of range: " + std::to_string(builder.vertices()) + " vertices stand before it");
  }
  return builder.vertices() + *number;
}

void read_statement(std::string_view statement, long long line, std::vector<std::int64_t>& corners,
                    MeshBuilder& builder) {
  WordReader words(statement);
  const std::string_view keyword = words.word();
  if (keyword == "v") {
    double point[3];
    for (double& coordinate : point) {
      if (words.at_end()) throw InputError(builder.file(), place(line, "", 0), "a vertex needs three coordinates");
      const std::string_view word = words.word();
      const auto number = parse_number(word);
      if (!number) throw InputError(builder.file(), place(line, "", 0), in_quotes(word) + " is not a number");
      coordinate = *number;
    }
    builder.add_vertex(point, line);
  } else if (keyword == "f" || keyword == "fo") {
    corners.clear();
    while (!words.at_end()) corners.push_back(parse_corner(words.word(), builder, line));
    builder.add_polygon(corners, line);
  }
}

}  // namespace

void read_obj(std::string_view content, MeshBuilder& builder) {
  builder.reserve(content.size() / 80, content.size() / 60);
  LineReader lines(content);
  std::string_view line;
  std::string joined;
  std::vector<std::int64_t> corners;
  while (lines.next(line)) {
    const long long number = lines.line();
    if (continued(line) && !line.starts_with('#')) {
      joined.clear();
      do {
        joined.append(line.substr(0, line.find_last_of('\\'))).push_back(' ');
      } while (lines.next(line) && continued(line));
      if (!continued(line)) joined.append(line);
      line = joined;
    }
    if (line.find_first_of("vf") == std::string_view::npos) continue;
    read_statement(line.substr(0, line.find('#')), number, corners, builder);
  }
}

std::string obj_text(const Mesh& mesh) {
  std::string text;
  text.reserve(static_cast<std::size_t>(mesh.vertices.rows()) * 60 + static_cast<std::size_t>(mesh.faces.rows()) * 24);
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
    text += 'v';
    for (int k = 0; k < 3; ++k) {
      text += ' ';
      append_number(text, mesh.vertices(v, k));
    }
    text += '\n';
  }
  std::vector<int> corners;
  for (const PolygonRange& range : polygon_ranges(mesh)) {
    polygon_corners(mesh, range, corners);
    text += 'f';
    for (const int corner : corners) {
      text += ' ';
      append_number(text, static_cast<long long>(corner) + 1);
    }
    text += '\n';
  }
  return text;
}

}  // namespace orbifit

#include <algorithm>
#include <cstdint>

#include <Eigen/Geometry>

#include "orbifit/model/errors.h"

#include "files/binary.h"
#include "files/mesh_formats.h"
#include "files/stl.h"
#include "files/text.h"

namespace orbifit {

namespace {

using stl::kHeader;
using stl::kTriangle;

void add_triangle(MeshBuilder& builder, long long line) {
  const std::int64_t count = builder.vertices();
  const std::int64_t corners[3] = {count - 3, count - 2, count - 1};
  builder.add_polygon(corners, line);
}

void read_binary(std::string_view content, MeshBuilder& builder) {
  const std::size_t triangles = load<std::uint32_t>(content.data() + 80);
  const std::size_t held = (content.size() - kHeader) / kTriangle;
  if (held != triangles) {
    throw InputError(builder.file(), "face " + std::to_string(std::min(held, triangles)),
                     std::string(held < triangles ? "the file is truncated: " : "") + "its header announces " +
                         std::to_string(triangles) + " triangles, it holds " + std::to_string(held));
  }
  builder.reserve(3 * triangles, triangles);
  for (std::size_t t = 0; t < triangles; ++t) {
    const char* corner = content.data() + kHeader + kTriangle * t + 12;
    for (int k = 0; k < 3; ++k, corner += 12) {
      builder.add_vertex({load<float>(corner), load<float>(corner + 4), load<float>(corner + 8)}, 0);
    }
    add_triangle(builder, 0);
  }
}

void read_vertex(WordReader& words, long long line, MeshBuilder& builder) {
  double point[3];
  for (double& coordinate : point) {
    const std::string_view word = words.word();
    const auto number = parse_number(word);
    if (!number) {
      throw InputError(builder.file(), place(line, "", 0),
                       word.empty() ? "a vertex needs three coordinates" : in_quotes(word) + " is not a number");
    }
    coordinate = *number;
  }
  builder.add_vertex(point, line);
}

void read_ascii(std::string_view content, MeshBuilder& builder) {
  LineReader lines(content);
  std::string_view line;
  int corners = 0;
  bool open = false;  // between "facet" and "endfacet"
  const auto refuse = [&](const std::string& reason) {
    throw InputError(builder.file(), place(lines.line(), "", 0), reason);
  };
  while (lines.next_content(line)) {
    WordReader words(line);
    const std::string keyword = lower_case(words.word());
    if (keyword == "facet") {
      if (open) refuse("'facet' within a facet");
      open = true;
      corners = 0;
    } else if (keyword == "vertex") {
      if (!open) refuse("'vertex' outside of a facet");
      read_vertex(words, lines.line(), builder);
      ++corners;
    } else if (keyword == "endfacet") {
      if (!open || corners != 3) refuse("a facet with " + std::to_string(corners) + " vertices: 3 are needed");
      open = false;
      add_triangle(builder, lines.line());
    }
  }
  if (open) refuse("the file ends within a facet");
}

}  // namespace

bool stl::is_text(std::string_view content) {
  const bool sized = content.size() >= kHeader &&
                     content.size() == kHeader + kTriangle * std::size_t{load<std::uint32_t>(content.data() + 80)};
  const std::string start = lower_case(content.substr(0, 5));
  return !sized && (start == "solid" || content.find("facet") < 200);
}

void read_stl(std::string_view content, MeshBuilder& builder) {
  if (stl::is_text(content)) return read_ascii(content, builder);
  if (content.size() < kHeader)
    throw InputError(builder.file(), "", "the file is truncated: not even an STL header fits");
  read_binary(content, builder);
}

std::string stl_bytes(const std::filesystem::path& file, const Mesh& mesh) {
  std::string bytes = "Orbifit";
  bytes.resize(80, ' ');
  store(bytes, static_cast<std::uint32_t>(mesh.faces.rows()));
  bytes.reserve(kHeader + kTriangle * static_cast<std::size_t>(mesh.faces.rows()));
  const Points normals = face_normals(mesh);
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) store(bytes, static_cast<float>(normals(f, k)));
    for (int corner = 0; corner < 3; ++corner) {
      for (int k = 0; k < 3; ++k) store(bytes, to_float(file, mesh.vertices(mesh.faces(f, corner), k)));
    }
    store(bytes, std::uint16_t{0});
  }
  return bytes;
}

}  // namespace orbifit

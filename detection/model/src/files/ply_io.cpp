#include <cmath>
#include <cstdint>
#include <vector>

#include "orbifit/model/errors.h"

#include "files/binary.h"
#include "files/mesh_formats.h"
#include "files/ply.h"
#include "files/text.h"

namespace orbifit {

namespace {

// Where the columns are that a mesh needs.
struct Columns {
  int position[3] = {-1, -1, -1};
  int corners = -1;
};

void find_columns(const PlyElement& element, const std::string& file, Columns& columns) {
  const auto is_list = [&](int p) { return element.properties[static_cast<std::size_t>(p)].count_type.has_value(); };
  if (element.name == "vertex") {
    for (int k = 0; k < 3; ++k) {
      columns.position[k] = element.find(std::string_view("xyz").substr(static_cast<std::size_t>(k), 1));
      if (columns.position[k] < 0 || is_list(columns.position[k])) {
        throw InputError(file, "header", std::string("element 'vertex' has no property '") + "xyz"[k] + "'");
      }
    }
  } else if (element.name == "face") {
    columns.corners = element.find("vertex_indices");
    if (columns.corners < 0) columns.corners = element.find("vertex_index");
    if (element.count > 0 && (columns.corners < 0 || !is_list(columns.corners))) {
      throw InputError(file, "header", "element 'face' has no list 'vertex_indices'");
    }
  }
}

std::uint8_t to_byte(double colour) {
  return static_cast<std::uint8_t>(std::lround(255 * std::clamp(colour, 0.0, 1.0)));
}

void store_colour(std::string& bytes, const Points& colours, Eigen::Index row) {
  for (int k = 0; k < 3; ++k) store(bytes, to_byte(colours(row, k)));
}

}  // namespace

void read_ply_mesh(std::string_view content, MeshBuilder& builder) {
  Columns columns;
  std::vector<std::int64_t> corners;
  const auto begin = [&](const PlyElement& element) { find_columns(element, builder.file(), columns); };
  const auto visit = [&](const PlyElement& element, const PlyRow& row) {
    if (element.name == "vertex") {
      const auto value = [&](int k) { return row.values[static_cast<std::size_t>(columns.position[k])]; };
      builder.add_vertex({value(0), value(1), value(2)}, row.line);
    } else if (element.name == "face") {
      corners.clear();
      for (const double corner : row.lists[static_cast<std::size_t>(columns.corners)]) {
        if (!(std::abs(corner) < 1e15) || corner != std::floor(corner)) {
          throw InputError(builder.file(), place(row.line, "face", row.number), "a vertex index is not an integer");
        }
        corners.push_back(static_cast<std::int64_t>(corner));
      }
      builder.add_polygon(corners, row.line);
    }
  };
  visit_ply(builder.file(), content, begin, visit);
}

std::string ply_bytes(const Mesh& mesh, const std::optional<Points>& colours) {
  const Points* face_colours = colours && colours->rows() == mesh.faces.rows() ? &*colours : nullptr;
  const Points* vertex_colours = colours && face_colours == nullptr ? &*colours : nullptr;
  if (vertex_colours != nullptr && vertex_colours->rows() != mesh.vertices.rows()) {
    throw UsageError("colours: " + std::to_string(colours->rows()) + " rows: one a face or one a vertex is needed");
  }
  const auto ranges = polygon_ranges(mesh, face_colours);
  int longest = 0;
  for (const PolygonRange& range : ranges) longest = std::max(longest, range.faces + 2);
  const std::string colour = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  std::string bytes = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(mesh.vertices.rows()) +
                      "\nproperty double x\nproperty double y\nproperty double z\n" +
                      (vertex_colours != nullptr ? colour : "") + "element face " + std::to_string(ranges.size()) +
                      "\nproperty list " + (longest > 255 ? "uint" : "uchar") + " int vertex_indices\n" +
                      (face_colours != nullptr ? colour : "") + "end_header\n";
  bytes.reserve(bytes.size() + 27 * static_cast<std::size_t>(mesh.vertices.rows()) +
                20 * static_cast<std::size_t>(mesh.faces.rows()));
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
    for (int k = 0; k < 3; ++k) store(bytes, mesh.vertices(v, k));
    if (vertex_colours != nullptr) store_colour(bytes, *vertex_colours, v);
  }
  std::vector<int> corners;
  for (const PolygonRange& range : ranges) {
    polygon_corners(mesh, range, corners);
    if (longest > 255) {
      store(bytes, static_cast<std::uint32_t>(corners.size()));
    } else {
      store(bytes, static_cast<std::uint8_t>(corners.size()));
    }
    for (const int corner : corners) store(bytes, static_cast<std::int32_t>(corner));
    if (face_colours != nullptr) store_colour(bytes, *face_colours, range.first_face);
  }
  return bytes;
}

}  // namespace orbifit

#include <array>
#include <limits>
#include <optional>

#include "orbifit/model/errors.h"

#include "files/ply.h"
#include "files/text.h"
#include "look/look_formats.h"

namespace orbifit {

namespace {

// Columns of an element that tell its look, and by what its colours are divided.
struct LookColumns {
  std::array<int, 4> colour{-1, -1, -1, -1};
  std::array<double, 4> full{1, 1, 1, 1};
  std::array<int, 3> normal{-1, -1, -1};
  std::array<int, 2> uv{-1, -1};

  explicit LookColumns(const PlyElement& element) {
    constexpr std::array<const char*, 4> kColours{"red", "green", "blue", "alpha"};
    for (std::size_t k = 0; k < 4; ++k) {
      colour[k] = column(element, kColours[k]);
      if (colour[k] < 0) continue;
      const PlyType type = element.properties[static_cast<std::size_t>(colour[k])].type;
      full[k] = type == PlyType::uint8 ? 255 : type == PlyType::uint16 ? 65535 : 1;
    }
    constexpr std::array<const char*, 3> kNormals{"nx", "ny", "nz"};
    for (std::size_t k = 0; k < 3; ++k) normal[k] = column(element, kNormals[k]);
    using Names = std::array<const char*, 2>;
    for (const Names& names : {Names{"s", "t"}, Names{"u", "v"}, Names{"texture_u", "texture_v"}}) {
      if (uv[0] >= 0 && uv[1] >= 0) break;
      uv = {column(element, names[0]), column(element, names[1])};
    }
  }

  static int column(const PlyElement& element, const char* name) {
    const int found = element.find(name);
    return found >= 0 && element.properties[static_cast<std::size_t>(found)].count_type ? -1 : found;
  }

  bool coloured() const { return colour[0] >= 0 && colour[1] >= 0 && colour[2] >= 0; }
  bool with_normals() const { return normal[0] >= 0 && normal[1] >= 0 && normal[2] >= 0; }
  bool with_uvs() const { return uv[0] >= 0 && uv[1] >= 0; }

  Eigen::RowVector4d colour_of(const PlyRow& row) const {
    Eigen::RowVector4d result = Eigen::RowVector4d::Ones();
    for (int k = 0; k < 4; ++k) {
      const auto c = static_cast<std::size_t>(k);
      if (colour[c] >= 0) result[k] = row.values[static_cast<std::size_t>(colour[c])] / full[c];
    }
    return result.cwiseMax(0).cwiseMin(1);
  }
};

}  // namespace

Appearance ply_look(const std::filesystem::path& file, std::string_view content, const Mesh& mesh) {
  Appearance vertices;
  Appearance faces;
  std::optional<LookColumns> columns;
  const auto begin = [&](const PlyElement& element) {
    columns.emplace(element);
    const Eigen::Index rows = element.count;
    if (element.name == "face" && columns->coloured()) faces.colours.resize(rows, 4);
    if (element.name != "vertex") return;
    if (columns->coloured()) vertices.colours.resize(rows, 4);
    if (columns->with_normals()) vertices.normals.resize(rows, 3);
    if (columns->with_uvs()) vertices.uvs.resize(rows, 2);
  };
  const auto visit = [&](const PlyElement& element, const PlyRow& row) {
    const auto value = [&](int column) { return row.values[static_cast<std::size_t>(column)]; };
    const Eigen::Index r = row.number;
    if (element.name == "face" && faces.colours.rows() > 0) faces.colours.row(r) = columns->colour_of(row);
    if (element.name != "vertex") return;
    if (columns->coloured()) vertices.colours.row(r) = columns->colour_of(row);
    if (columns->with_normals()) {
      Eigen::Vector3d normal(value(columns->normal[0]), value(columns->normal[1]), value(columns->normal[2]));
      vertices.normals.row(r) = normal.normalized().transpose();
    }
    if (columns->with_uvs()) vertices.uvs.row(r) << value(columns->uv[0]), value(columns->uv[1]);
  };
  visit_ply(file.string(), content, begin, visit);

  Appearance look;
  const Eigen::Index corners = 3 * mesh.faces.rows();
  const bool face_colours = vertices.colours.rows() == 0 && faces.colours.rows() > 0;
  if (vertices.colours.rows() > 0 || face_colours) look.colours.resize(corners, 4);
  if (vertices.normals.rows() > 0) look.normals.resize(corners, 3);
  if (vertices.uvs.rows() > 0) look.uvs.resize(corners, 2);
  for (Eigen::Index c = 0; c < corners; ++c) {
    const int vertex = mesh.faces(c / 3, c % 3);
    const auto face = static_cast<std::size_t>(c / 3);
    if (vertices.colours.rows() > 0) look.colours.row(c) = vertices.colours.row(vertex);
    if (face_colours) {
      look.colours.row(c) = faces.colours.row(mesh.polygon_of_face.empty() ? c / 3 : mesh.polygon_of_face[face]);
    }
    if (vertices.normals.rows() > 0) look.normals.row(c) = vertices.normals.row(vertex);
    if (vertices.uvs.rows() > 0) look.uvs.row(c) = vertices.uvs.row(vertex);
  }
  return look;
}

}  // namespace orbifit

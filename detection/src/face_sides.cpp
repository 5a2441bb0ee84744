#include "face_sides.h"

#include <algorithm>

#include "orbifit/model/topology.h"

namespace orbifit {

std::vector<std::array<FaceSide, 3>> face_sides(const PreparedMesh& prepared) {
  std::vector<std::array<FaceSide, 3>> result(static_cast<std::size_t>(prepared.mesh.faces.rows()));
  const auto point = [&](int group) -> Eigen::Vector3d {
    return prepared.mesh.vertices.row(prepared.weld.representative[static_cast<std::size_t>(group)]);
  };
  const auto add = [&](int face, int other, const Edge& edge) {
    auto& sides = result[static_cast<std::size_t>(face)];
    const auto free = std::ranges::find(sides, -1, &FaceSide::face);
    const double length = (point(edge.vertices[0]) - point(edge.vertices[1])).norm();
    if (free != sides.end()) *free = {other, length, {edge.vertices[0], edge.vertices[1]}};
  };
  for (const Edge& edge : welded_edges(prepared.mesh, prepared.weld)) {
    if (edge.faces.size() != 2) continue;
    add(edge.faces[0], edge.faces[1], edge);
    add(edge.faces[1], edge.faces[0], edge);
  }
  return result;
}

}  // namespace orbifit

#include "surface/face_sides.h"

#include <algorithm>

#include "base/disjoint_sets.h"
#include "geometry/topology.h"

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

std::vector<int> without_specks(const PreparedMesh& prepared, const std::vector<std::array<FaceSide, 3>>& sides,
                                const std::vector<int>& faces) {
  constexpr double kSpeck = 0.01;
  constexpr double kMax = 0.03;
  const auto place = [&](int face) {  // among the faces; -1 for others
    const auto found = std::ranges::lower_bound(faces, face);
    return found != faces.end() && *found == face ? static_cast<int>(found - faces.begin()) : -1;
  };
  DisjointSets patches(faces.size());
  for (std::size_t i = 0; i < faces.size(); ++i) {
    for (const FaceSide& side : sides[static_cast<std::size_t>(faces[i])]) {
      const int other = side.face < 0 ? -1 : place(side.face);
      if (other >= 0) patches.unite(static_cast<int>(i), other);
    }
  }
  std::vector<double> areas(faces.size(), 0);
  double all = 0;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    areas[static_cast<std::size_t>(patches.root(static_cast<int>(i)))] += prepared.areas[faces[i]];
    all += prepared.areas[faces[i]];
  }
  std::vector<int> rest;
  double specks = 0;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    if (areas[static_cast<std::size_t>(patches.root(static_cast<int>(i)))] < kSpeck * all) {
      specks += prepared.areas[faces[i]];
    } else {
      rest.push_back(faces[i]);
    }
  }
  return specks <= kMax * all ? rest : faces;
}

}  // namespace orbifit

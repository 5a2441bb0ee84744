#include "vertex_places.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

namespace orbifit {

namespace {

constexpr double kWeld = 1e-9;  // of the diagonal

int root(std::vector<int>& parents, int v) {
  while (parents[static_cast<std::size_t>(v)] != v) {
    int& parent = parents[static_cast<std::size_t>(v)];
    parent = parents[static_cast<std::size_t>(parent)];
    v = parent;
  }
  return v;
}

// A side of a face: the welded ends, ascending, and the vertices there.
struct Side {
  std::array<int, 2> ends;
  std::array<int, 2> vertices;
};

// Joins vertices at one position whose faces meet in an edge of two faces.
std::vector<int> linked(const Mesh& mesh, const std::vector<int>& weld) {
  std::vector<Side> sides;
  sides.reserve(static_cast<std::size_t>(3 * mesh.faces.rows()));
  for (Eigen::Index face = 0; face < mesh.faces.rows(); ++face) {
    for (int k = 0; k < 3; ++k) {
      std::array<int, 2> vertices{mesh.faces(face, k), mesh.faces(face, (k + 1) % 3)};
      std::array<int, 2> ends{weld[static_cast<std::size_t>(vertices[0])], weld[static_cast<std::size_t>(vertices[1])]};
      if (ends[0] == ends[1]) continue;
      if (ends[0] > ends[1]) {
        std::swap(ends[0], ends[1]);
        std::swap(vertices[0], vertices[1]);
      }
      sides.push_back({ends, vertices});
    }
  }
  std::ranges::sort(sides, {}, &Side::ends);
  std::vector<int> parents(weld.size());
  std::iota(parents.begin(), parents.end(), 0);
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t end = i + 1;
    while (end < sides.size() && sides[end].ends == sides[i].ends) ++end;
    if (end == i + 2) {
      for (std::size_t k = 0; k < 2; ++k) {
        const int a = root(parents, sides[i].vertices[k]);
        const int b = root(parents, sides[i + 1].vertices[k]);
        parents[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
      }
    }
    i = end;
  }
  return parents;
}

}  // namespace

std::vector<int> welded_vertices(const Points& vertices) {
  const double tolerance = kWeld * diagonal(vertices);
  std::vector<int> result(static_cast<std::size_t>(vertices.rows()));
  std::iota(result.begin(), result.end(), 0);
  if (!(tolerance > 0)) return result;
  const VertexGrid grid(vertices, tolerance);
  for (std::size_t v = 0; v < result.size(); ++v) {
    grid.visit(vertices.row(static_cast<Eigen::Index>(v)).transpose(),
               [&](int other) { result[v] = std::min(result[v], other); });
  }
  return result;
}

std::vector<int> sets_of_vertices(const Mesh& mesh, const RegionMap& regions) {
  std::vector<int> sets(static_cast<std::size_t>(mesh.vertices.rows()), 0);
  const auto add = [&](int vertex, int set) {
    int& here = sets[static_cast<std::size_t>(vertex)];
    if (here != set) here = regions.joined(here, set);
  };
  for (Eigen::Index face = 0; face < mesh.faces.rows(); ++face) {
    for (const int vertex : mesh.faces.row(face)) add(vertex, regions.set_of_face(static_cast<int>(face)));
  }
  if (regions.places() == 0) return sets;
  const std::vector<int> weld = welded_vertices(mesh.vertices);
  bool doubled = false;
  for (std::size_t v = 0; v < weld.size(); ++v) doubled = doubled || weld[v] != static_cast<int>(v);
  if (!doubled) return sets;
  std::vector<int> parents = linked(mesh, weld);
  for (int v = 0; v < static_cast<int>(weld.size()); ++v) add(root(parents, v), sets[static_cast<std::size_t>(v)]);
  for (int v = 0; v < static_cast<int>(weld.size()); ++v) add(v, sets[static_cast<std::size_t>(root(parents, v))]);
  return sets;
}

bool PlacesOfVertices::has_same(const Eigen::Vector3d& position, int set) const {
  bool result = false;
  grid_.visit(position, [&](int vertex) { result = result || sets_[static_cast<std::size_t>(vertex)] == set; });
  return result;
}

int PlacesOfVertices::set_at(const Eigen::Vector3d& position, int carried) const {
  int result = -1;
  bool same = false;
  grid_.visit(position, [&](int vertex) {
    const int here = sets_[static_cast<std::size_t>(vertex)];
    same = same || here == carried;
    if (regions_.comparable(here, carried)) result = regions_.joined(result < 0 ? carried : result, here);
  });
  return same ? carried : result;
}

}  // namespace orbifit

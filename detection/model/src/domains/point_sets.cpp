#include "domains/point_sets.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include "domains/domain_map.h"
#include "geometry/side_order.h"
#include "geometry/vertex_grid.h"

namespace orbifit {

namespace {

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
  sort_by_ends(sides, weld.size(), &Side::ends);
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
  const double tolerance = kSamePosition * diagonal(vertices);
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

PointSets point_sets(const Mesh& mesh, const DomainMap& domains) {
  PointSets result;
  result.sets.assign(static_cast<std::size_t>(mesh.vertices.rows()), 0);
  result.roots.resize(result.sets.size());
  std::iota(result.roots.begin(), result.roots.end(), 0);
  result.weld = result.roots;
  if (domains.places() > 0) {
    result.weld = welded_vertices(mesh.vertices);
    if (result.weld != result.roots) {
      std::vector<int> parents = linked(mesh, result.weld);
      for (int v = 0; v < static_cast<int>(parents.size()); ++v) {
        result.roots[static_cast<std::size_t>(v)] = root(parents, v);
      }
    }
  }
  for (Eigen::Index face = 0; face < mesh.faces.rows(); ++face) {
    const int set = domains.set_of_face(static_cast<int>(face));
    for (const int vertex : mesh.faces.row(face)) {
      int& here = result.sets[static_cast<std::size_t>(result.roots[static_cast<std::size_t>(vertex)])];
      if (here != set) here = domains.joined(here, set);
    }
  }
  return result;
}

std::vector<int> by_vertex(const PointSets& points) {
  std::vector<int> result;
  result.reserve(points.roots.size());
  for (const int root : points.roots) result.push_back(points.sets[static_cast<std::size_t>(root)]);
  return result;
}

}  // namespace orbifit

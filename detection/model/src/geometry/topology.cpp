#include "geometry/topology.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <unordered_map>
#include <utility>

#include <Eigen/Geometry>

#include "base/disjoint_sets.h"
#include "geometry/grid_cell.h"
#include "geometry/side_order.h"

namespace orbifit {

namespace {

// A cross product of differences is rounded at this fraction of the longest side squared.
constexpr double kRounding = 1e-15;

using Cell = std::array<std::int64_t, 3>;

// Groups in the cells of a regular grid, found again within a tolerance.
class GroupGrid {
 public:
  GroupGrid(const Points& vertices, double tolerance) : vertices_(vertices), tolerance_(tolerance) {
    origin_ = vertices.colwise().minCoeff();
    // Wide cells, so that most vertices look into one cell only; and never so many that their numbers overflow.
    cell_ = std::max(4 * tolerance, 1e-15 * (vertices.colwise().maxCoeff() - origin_).maxCoeff());
    if (!(cell_ > 0)) cell_ = 1;
    first_.assign(std::bit_ceil(2 * static_cast<std::size_t>(vertices.rows())), -1);
  }

  // The group whose first vertex is nearest within the tolerance, the lowest number among equals; -1 for none.
  int find(const Eigen::RowVector3d& point, const std::vector<int>& representative) const {
    const double reach = tolerance_ * (1 + 1e-9);
    const Cell low = cell_of(point.array() - reach);
    const Cell high = cell_of(point.array() + reach);
    int best = -1;
    double best_distance = std::numeric_limits<double>::infinity();
    for (std::int64_t x = low[0]; x <= high[0]; ++x) {
      for (std::int64_t y = low[1]; y <= high[1]; ++y) {
        for (std::int64_t z = low[2]; z <= high[2]; ++z) {
          const Cell cell{x, y, z};
          for (int group = first_[slot_of(cell)]; group >= 0; group = next_[static_cast<std::size_t>(group)]) {
            if (cells_[static_cast<std::size_t>(group)] != cell) continue;
            const double distance =
                (vertices_.row(representative[static_cast<std::size_t>(group)]) - point).stableNorm();
            if (distance > tolerance_) continue;
            if (distance < best_distance || (distance == best_distance && group < best)) {
              best = group;
              best_distance = distance;
            }
          }
        }
      }
    }
    return best;
  }

  // Groups come in the order of their numbers.
  void insert(const Eigen::RowVector3d& point) {
    const Cell& cell = cells_.emplace_back(cell_of(point));
    next_.push_back(std::exchange(first_[slot_of(cell)], static_cast<int>(next_.size())));
  }

 private:
  std::size_t slot_of(const Cell& cell) const { return CellHash{}(cell) & (first_.size() - 1); }
  Cell cell_of(const Eigen::RowVector3d& point) const { return grid_cell(Eigen::RowVector3d(point - origin_), cell_); }

  const Points& vertices_;
  double tolerance_;
  double cell_ = 1;
  Eigen::RowVector3d origin_;
  std::vector<Cell> cells_;  // by group
  std::vector<int> first_;   // by slot of a hash table: the last group that came there; -1: none
  std::vector<int> next_;    // by group: the one that came to the same slot before
};

std::array<int, 3> corner_groups(const Mesh& mesh, const Weld& weld, Eigen::Index face) {
  std::array<int, 3> groups{};
  for (int k = 0; k < 3; ++k) {
    groups[static_cast<std::size_t>(k)] = weld.group_of_vertex[static_cast<std::size_t>(mesh.faces(face, k))];
  }
  return groups;
}

bool collapsed(const std::array<int, 3>& corners) {
  return corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0];
}

struct EdgeUse {
  std::array<int, 2> vertices;  // ascending
  int face;
};

// Every side of every face that has two ends, by vertices, then face.
std::vector<EdgeUse> edge_uses(const Mesh& mesh, const Weld& weld, bool of_collapsed_faces) {
  std::vector<EdgeUse> uses;
  uses.reserve(3 * static_cast<std::size_t>(mesh.faces.rows()));
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    const std::array<int, 3> corners = corner_groups(mesh, weld, f);
    if (!of_collapsed_faces && collapsed(corners)) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(corners[k], corners[(k + 1) % 3]);
      if (low != high) uses.push_back({{low, high}, static_cast<int>(f)});
    }
  }
  sort_by_ends(uses, weld.group_of_vertex.size(), &EdgeUse::vertices);
  return uses;
}

// Whether the face runs from the edge's first to its second vertex.
bool runs_upwards(const std::array<int, 3>& corners, const std::array<int, 2>& edge) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (corners[k] == edge[0] && corners[(k + 1) % 3] == edge[1]) return true;
  }
  return false;
}

int count_duplicate_faces(const Mesh& mesh, const Weld& weld) {
  std::vector<std::array<int, 3>> sorted;
  sorted.reserve(static_cast<std::size_t>(mesh.faces.rows()));
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    std::array<int, 3> corners = corner_groups(mesh, weld, f);
    std::sort(corners.begin(), corners.end());
    sorted.push_back(corners);
  }
  std::sort(sorted.begin(), sorted.end());
  const auto distinct = std::unique(sorted.begin(), sorted.end()) - sorted.begin();
  return static_cast<int>(mesh.faces.rows() - distinct);
}

int count_degenerate_faces(const Mesh& mesh, const Weld& weld) {
  const Eigen::VectorXd areas = face_areas(mesh);
  int count = 0;
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    double longest = 0;
    for (int k = 0; k < 3; ++k) {
      longest = std::max(longest,
                         (mesh.vertices.row(mesh.faces(f, (k + 1) % 3)) - mesh.vertices.row(mesh.faces(f, k))).norm());
    }
    if (collapsed(corner_groups(mesh, weld, f)) || !(areas[f] > kRounding * longest * longest)) ++count;
  }
  return count;
}

// Signed: negative for a surface turned inside out.
double enclosed_volume(const Mesh& mesh) {
  const Eigen::Vector3d centre = bounding_box_centre(mesh.vertices);
  double volume = 0;
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    const auto corner = [&](int k) -> Eigen::Vector3d {
      return mesh.vertices.row(mesh.faces(f, k)).transpose() - centre;
    };
    volume += corner(0).dot(corner(1).cross(corner(2))) / 6;
  }
  return volume;
}

// The mesh's own vertices at the ends of a side, ascending; nothing where a face has two such sides.
std::optional<std::array<int, 2>> own_vertices(const Mesh& mesh, const Weld& weld, const EdgeUse& use) {
  std::optional<std::array<int, 2>> own;
  for (int k = 0; k < 3; ++k) {
    const int a = mesh.faces(use.face, k);
    const int b = mesh.faces(use.face, (k + 1) % 3);
    const auto [low, high] = std::minmax(weld.group_of_vertex[static_cast<std::size_t>(a)],
                                         weld.group_of_vertex[static_cast<std::size_t>(b)]);
    if (low != use.vertices[0] || high != use.vertices[1]) continue;
    if (own) return std::nullopt;
    own = {std::min(a, b), std::max(a, b)};
  }
  return own;
}

// Whether the mesh's own vertices pair the faces at an edge, no more and no fewer than two each; then those of a pair
// come to stand side by side.
bool pair_by_vertices(const Mesh& mesh, const Weld& weld, std::span<EdgeUse> uses) {
  if (uses.size() % 2 != 0) return false;
  std::vector<std::pair<std::array<int, 2>, EdgeUse>> by_vertices;
  for (const EdgeUse& use : uses) {
    const std::optional<std::array<int, 2>> own = own_vertices(mesh, weld, use);
    if (!own) return false;
    by_vertices.emplace_back(*own, use);
  }
  std::ranges::stable_sort(by_vertices, {}, [](const auto& each) { return each.first; });
  for (std::size_t i = 0; i < by_vertices.size(); ++i) {
    const bool same = i > 0 && by_vertices[i].first == by_vertices[i - 1].first;
    if (same != (i % 2 == 1)) return false;
  }
  for (std::size_t i = 0; i < uses.size(); ++i) uses[i] = by_vertices[i].second;
  return true;
}

// Unites sets most of whose faces repeat another set's: the two sides of a sheet.
void unite_doubled(const Mesh& mesh, const Weld& weld, DisjointSets& sets) {
  constexpr std::size_t kMax = 8;  // faces on one another: of more none is the side of a sheet
  std::vector<std::pair<std::array<int, 3>, int>> corners;
  std::unordered_map<int, std::size_t> sizes;
  for (int f = 0; f < mesh.faces.rows(); ++f) {
    std::array<int, 3> key = corner_groups(mesh, weld, f);
    std::ranges::sort(key);
    corners.emplace_back(key, f);
    ++sizes[sets.root(f)];
  }
  std::ranges::sort(corners);
  std::map<std::array<int, 2>, std::size_t> common;  // faces that the first set repeats of the second
  for (std::size_t first = 0; first < corners.size();) {
    std::size_t last = first + 1;
    while (last < corners.size() && corners[last].first == corners[first].first) ++last;
    for (std::size_t i = first; i < last && last - first <= kMax; ++i) {
      for (std::size_t j = first; j < last; ++j) {
        const int mine = sets.root(corners[i].second);
        const int other = sets.root(corners[j].second);
        if (mine != other) ++common[{mine, other}];
      }
    }
    first = last;
  }
  for (const auto& [pair, count] : common) {
    if (2 * count > sizes[pair[0]]) sets.unite(pair[0], pair[1]);
  }
}

Components components_of(DisjointSets& sets) {
  Components components;
  components.component_of_face.assign(sets.size(), -1);
  for (std::size_t f = 0; f < sets.size(); ++f) {
    // The root is the component's first face, so its number is known by now.
    const auto root = static_cast<std::size_t>(sets.root(static_cast<int>(f)));
    if (root == f) {
      components.component_of_face[f] = static_cast<int>(components.faces.size());
      components.faces.emplace_back();
    } else {
      components.component_of_face[f] = components.component_of_face[root];
    }
    components.faces[static_cast<std::size_t>(components.component_of_face[f])].push_back(static_cast<int>(f));
  }
  return components;
}

}  // namespace

Weld weld_vertices(const Points& vertices, double tolerance) {
  Weld weld;
  if (vertices.rows() == 0) return weld;
  weld.group_of_vertex.reserve(static_cast<std::size_t>(vertices.rows()));
  GroupGrid grid(vertices, std::max(tolerance, 0.0));
  for (Eigen::Index v = 0; v < vertices.rows(); ++v) {
    int group = grid.find(vertices.row(v), weld.representative);
    if (group < 0) {
      group = static_cast<int>(weld.representative.size());
      weld.representative.push_back(static_cast<int>(v));
      grid.insert(vertices.row(v));
    }
    weld.group_of_vertex.push_back(group);
  }
  return weld;
}

Components connected_components(const Mesh& mesh, const Weld& weld) {
  DisjointSets sets(static_cast<std::size_t>(mesh.faces.rows()));
  const std::vector<EdgeUse> uses = edge_uses(mesh, weld, true);
  for (std::size_t i = 1; i < uses.size(); ++i) {
    if (uses[i].vertices == uses[i - 1].vertices) sets.unite(uses[i].face, uses[i - 1].face);
  }
  return components_of(sets);
}

Components touching_parts(const Mesh& mesh, const Weld& weld, DoubledParts doubled) {
  DisjointSets sets(static_cast<std::size_t>(mesh.faces.rows()));
  std::vector<EdgeUse> uses = edge_uses(mesh, weld, true);
  for (std::size_t first = 0; first < uses.size();) {
    std::size_t last = first + 1;
    while (last < uses.size() && uses[last].vertices == uses[first].vertices) ++last;
    const std::span<EdgeUse> here = std::span(uses).subspan(first, last - first);
    const bool apart = here.size() > 2 && pair_by_vertices(mesh, weld, here);
    for (std::size_t i = 1; i < here.size(); ++i) {
      if (!apart || i % 2 == 1) sets.unite(here[i].face, here[i - 1].face);
    }
    first = last;
  }
  if (doubled == DoubledParts::united) unite_doubled(mesh, weld, sets);
  return components_of(sets);
}

std::vector<Edge> welded_edges(const Mesh& mesh, const Weld& weld) {
  std::vector<Edge> edges;
  for (const EdgeUse& use : edge_uses(mesh, weld, false)) {
    if (edges.empty() || edges.back().vertices != use.vertices) edges.push_back({use.vertices, {}});
    edges.back().faces.push_back(use.face);
  }
  return edges;
}

MeshReport inspect(const Mesh& mesh) {
  MeshReport report;
  report.vertices = static_cast<int>(mesh.vertices.rows());
  report.faces = static_cast<int>(mesh.faces.rows());
  if (report.vertices == 0) return report;
  const Weld weld = weld_vertices(mesh.vertices);
  report.components = static_cast<int>(connected_components(mesh, weld).faces.size());
  report.duplicate_vertices = report.vertices - static_cast<int>(weld.representative.size());

  std::vector<bool> used(static_cast<std::size_t>(report.vertices), false);
  for (const int vertex : mesh.faces.reshaped()) used[static_cast<std::size_t>(vertex)] = true;
  report.unused_vertices = static_cast<int>(std::count(used.begin(), used.end(), false));
  report.degenerate_faces = count_degenerate_faces(mesh, weld);
  report.duplicate_faces = count_duplicate_faces(mesh, weld);

  const std::vector<Edge> edges = welded_edges(mesh, weld);
  for (const Edge& edge : edges) {
    if (edge.faces.size() == 1) ++report.boundary_edges;
    if (edge.faces.size() > 2) ++report.non_manifold_edges;
    if (edge.faces.size() == 2 && runs_upwards(corner_groups(mesh, weld, edge.faces[0]), edge.vertices) ==
                                      runs_upwards(corner_groups(mesh, weld, edge.faces[1]), edge.vertices)) {
      ++report.inconsistent_edges;
    }
  }
  report.watertight = !edges.empty() && report.boundary_edges == 0 && report.non_manifold_edges == 0;
  report.area = face_areas(mesh).sum();
  if (report.watertight) report.volume = enclosed_volume(mesh);
  report.diagonal = diagonal(mesh.vertices);
  report.minimum = mesh.vertices.colwise().minCoeff();
  report.maximum = mesh.vertices.colwise().maxCoeff();
  return report;
}

}  // namespace orbifit

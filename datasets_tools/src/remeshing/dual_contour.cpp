#include "remeshing/dual_contour.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "remeshing/plane_fit.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;
using Node = std::array<int, 3>;

// Corners of a cell are numbered by the bits x, y, z. Edge 4 d + a + 2 b runs along axis d; a and b are its place along
// axes d + 1 and d + 2. Face 2 d + s is the one across axis d at place s.
constexpr std::size_t kEdges = 12;
constexpr std::size_t kFaces = 6;

constexpr std::size_t axis_after(std::size_t axis, std::size_t steps = 1) {
  return (axis + steps) % 3;
}

constexpr std::size_t edge_of(std::size_t axis, std::size_t a, std::size_t b) {
  return 4 * axis + a + 2 * b;
}

// The four edges around a face and its four corners: edge k runs from corner k to corner k + 1.
struct FaceLoop {
  std::array<std::size_t, 4> corners, edges;
};

FaceLoop loop_of(std::size_t face) {
  const std::size_t d = face / 2;
  const std::size_t side = face % 2;
  const std::size_t u = axis_after(d);
  const std::size_t v = axis_after(d, 2);
  const auto corner = [&](std::size_t at_u, std::size_t at_v) { return (side << d) | (at_u << u) | (at_v << v); };
  // Axes after u are v and d; after v they are d and u.
  return {{corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)},
          {edge_of(u, 0, side), edge_of(v, side, 1), edge_of(u, 1, side), edge_of(v, side, 0)}};
}

const std::array<FaceLoop, kFaces>& face_loops() {
  static const std::array<FaceLoop, kFaces> loops = [] {
    std::array<FaceLoop, kFaces> result;
    for (std::size_t face = 0; face < kFaces; ++face) result[face] = loop_of(face);
    return result;
  }();
  return loops;
}

// The sheets of a cell: which of its edges each of them crosses.
struct Sheets {
  std::array<std::int8_t, kEdges> of_edge{};  // -1: not crossed
  int count = 0;
};

bool inner(unsigned corners, std::size_t corner) {
  return ((corners >> corner) & 1U) != 0;
}

bool ambiguous(unsigned corners, std::size_t face) {
  const auto& at = face_loops()[face].corners;
  return inner(corners, at[0]) == inner(corners, at[2]) && inner(corners, at[1]) == inner(corners, at[3]) &&
         inner(corners, at[0]) != inner(corners, at[1]);
}

// On an ambiguous face the sheets keep the inner corners apart, or on a joining one the outer corners.
Sheets sheets_of(unsigned corners, unsigned joining_faces) {
  std::array<std::array<std::size_t, 2>, kEdges> linked{};
  std::array<std::size_t, kEdges> links{};
  const auto link = [&](std::size_t a, std::size_t b) {
    linked[a][links[a]++] = b;
    linked[b][links[b]++] = a;
  };
  for (std::size_t face = 0; face < kFaces; ++face) {
    const FaceLoop& loop = face_loops()[face];
    if (ambiguous(corners, face)) {
      const bool apart = ((joining_faces >> face) & 1U) == 0;
      // Edges k - 1 and k meet at corner k.
      for (std::size_t k = 0; k < 4; ++k) {
        if (inner(corners, loop.corners[k]) == apart) link(loop.edges[(k + 3) % 4], loop.edges[k]);
      }
      continue;
    }
    std::array<std::size_t, 2> crossed{};
    std::size_t count = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      if (inner(corners, loop.corners[k]) != inner(corners, loop.corners[(k + 1) % 4]))
        crossed[count++] = loop.edges[k];
    }
    if (count == 2) link(crossed[0], crossed[1]);
  }
  Sheets sheets;
  sheets.of_edge.fill(-1);
  for (std::size_t first = 0; first < kEdges; ++first) {
    if (links[first] == 0 || sheets.of_edge[first] >= 0) continue;
    // Every crossed edge has two links, so a sheet is a ring of edges.
    std::vector<std::size_t> open{first};
    while (!open.empty()) {
      const std::size_t edge = open.back();
      open.pop_back();
      if (sheets.of_edge[edge] >= 0) continue;
      sheets.of_edge[edge] = static_cast<std::int8_t>(sheets.count);
      open.insert(open.end(), linked[edge].begin(), linked[edge].end());
    }
    ++sheets.count;
  }
  return sheets;
}

struct Cell {
  std::int64_t key;  // place in the grid
  unsigned corners = 0;
  unsigned joining = 0;  // faces
  int first_vertex = 0;
  Sheets sheets;
};

class Contourer {
 public:
  Contourer(const UnionScan& scan, const Points& normals) : scan_(scan), normals_(normals) {}

  DualSurface operator()(RunContext& context) {
    find_cells();
    context.progress("contour", 0.1);
    part_sheets();
    gather_planes();
    context.progress("contour", 0.5);
    place_vertices(context);
    return std::move(surface_);
  }

 private:
  std::int64_t key_of(const Node& at) const {
    const auto& nodes = scan_.nodes();
    return at[0] + nodes[0] * (at[1] + static_cast<std::int64_t>(nodes[1]) * at[2]);
  }

  Node place_of(std::int64_t key) const {
    const auto& nodes = scan_.nodes();
    return {static_cast<int>(key % nodes[0]), static_cast<int>(key / nodes[0] % nodes[1]),
            static_cast<int>(key / nodes[0] / nodes[1])};
  }

  Cell* cell_at(const Node& at) {
    const std::int64_t key = key_of(at);
    const auto found = std::ranges::lower_bound(cells_, key, {}, &Cell::key);
    return found != cells_.end() && found->key == key ? &*found : nullptr;
  }

  void find_cells() {
    const auto& nodes = scan_.nodes();
    for (int z = 0; z + 1 < nodes[2]; ++z) {
      for (int y = 0; y + 1 < nodes[1]; ++y) {
        for (int x = 0; x + 1 < nodes[0]; ++x) {
          unsigned corners = 0;
          for (unsigned c = 0; c < 8; ++c) {
            const bool is_inside = scan_.inside(x + static_cast<int>(c & 1U), y + static_cast<int>((c >> 1U) & 1U),
                                                z + static_cast<int>(c >> 2U));
            if (is_inside) corners |= 1U << c;
          }
          if (corners != 0 && corners != 255) cells_.push_back({key_of({x, y, z}), corners, 0, 0, {}});
        }
      }
    }
  }

  // Whether both sheets' traces on an ambiguous face belong to one sheet of the cell.
  static bool one_sheet(const Cell& cell, std::size_t face) {
    const auto& edges = face_loops()[face].edges;
    const auto sheet = [&](std::size_t k) { return cell.sheets.of_edge[edges[k]]; };
    return sheet(0) == sheet(1) && sheet(1) == sheet(2) && sheet(2) == sheet(3);
  }

  void part_sheets() {
    for (Cell& cell : cells_) cell.sheets = sheets_of(cell.corners, cell.joining);
    // Where two cells would join over a face by one sheet each, four quadrangles would share an edge: join the other
    // way.
    for (bool changed = true; changed;) {
      changed = false;
      for (Cell& cell : cells_) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const std::size_t face = 2 * axis + 1;
          if (!ambiguous(cell.corners, face) || ((cell.joining >> face) & 1U) != 0 || !one_sheet(cell, face)) continue;
          Node next = place_of(cell.key);
          ++next[axis];
          Cell& neighbour = *cell_at(next);
          if (!one_sheet(neighbour, face - 1)) continue;
          cell.joining |= 1U << face;
          neighbour.joining |= 1U << (face - 1);
          cell.sheets = sheets_of(cell.corners, cell.joining);
          neighbour.sheets = sheets_of(neighbour.corners, neighbour.joining);
          changed = true;
        }
      }
    }
    int vertices = 0;
    for (Cell& cell : cells_) {
      cell.first_vertex = vertices;
      vertices += cell.sheets.count;
    }
    planes_.resize(static_cast<std::size_t>(vertices));
  }

  // Every crossed edge: a quadrangle, and a plane for each of its four vertices.
  void gather_planes() {
    const auto& nodes = scan_.nodes();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t u = axis_after(axis);
      const std::size_t v = axis_after(axis, 2);
      Node at{};
      for (at[2] = 0; at[2] < nodes[2] - (axis == 2 ? 1 : 0); ++at[2]) {
        for (at[1] = 0; at[1] < nodes[1] - (axis == 1 ? 1 : 0); ++at[1]) {
          for (at[0] = 0; at[0] < nodes[0] - (axis == 0 ? 1 : 0); ++at[0]) {
            Node next = at;
            ++next[axis];
            const bool leaves = scan_.inside(at[0], at[1], at[2]);
            if (leaves == scan_.inside(next[0], next[1], next[2])) continue;
            add_quad(at, axis, u, v, leaves);
          }
        }
      }
    }
  }

  void add_quad(const Node& at, std::size_t axis, std::size_t u, std::size_t v, bool leaves) {
    const Crossing crossing = scan_.crossing(static_cast<int>(axis), at);
    Vector3d point(at[0], at[1], at[2]);
    point[static_cast<Eigen::Index>(axis)] = crossing.place;
    Vector3d normal = Vector3d::Zero();
    if (crossing.face >= 0) normal = normals_.row(crossing.face);
    // The cells around the edge, counterclockwise as seen from the axis' far end; the edge's place in each.
    constexpr std::array<std::array<int, 2>, 4> kAround{{{1, 1}, {0, 1}, {0, 0}, {1, 0}}};
    std::array<int, 4> quad{};
    for (std::size_t k = 0; k < 4; ++k) {
      Node place = at;
      place[u] -= kAround[k][0];
      place[v] -= kAround[k][1];
      const Cell& cell = *cell_at(place);
      const std::size_t edge =
          edge_of(axis, static_cast<std::size_t>(kAround[k][0]), static_cast<std::size_t>(kAround[k][1]));
      quad[k] = cell.first_vertex + cell.sheets.of_edge[edge];
      planes_[static_cast<std::size_t>(quad[k])].add(point, normal, 1);
    }
    if (!leaves) std::swap(quad[1], quad[3]);
    surface_.quads.push_back(quad);
    surface_.crossings.push_back(point);
  }

  void place_vertices(RunContext& context) {
    surface_.vertices.resize(static_cast<Eigen::Index>(planes_.size()), 3);
    parallel_for(context, cells_.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t c = begin; c < end; ++c) {
        const Node at = place_of(cells_[c].key);
        const Vector3d low(at[0], at[1], at[2]);
        for (int s = 0; s < cells_[c].sheets.count; ++s) {
          const int vertex = cells_[c].first_vertex + s;
          const PlaneFit& fit = planes_[static_cast<std::size_t>(vertex)];
          surface_.vertices.row(vertex) = fit.nearest_to(fit.mean(), low, low + Vector3d::Ones());
        }
      }
    });
  }

  const UnionScan& scan_;
  const Points& normals_;
  std::vector<Cell> cells_;       // ascending keys
  std::vector<PlaneFit> planes_;  // of each vertex
  DualSurface surface_;
};

}  // namespace

DualSurface dual_contour(const UnionScan& scan, const Points& normals, RunContext& context) {
  return Contourer(scan, normals)(context);
}

}  // namespace orbifit

#include "remeshing/union_scan.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "remeshing/grid_flood.h"

namespace orbifit {

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Gaps and walls thinner than this, in cells, are rounding between faces that touch.
constexpr double kTouching = 1e-7;

// Pieces of fewer nodes than this were torn off a thin part, or are parts that the grid does not resolve.
constexpr std::size_t kCrumb = 8;

// A face met by a line.
struct Event {
  double place;
  int face;
  bool leaves;  // by the orientation of the face

  bool operator<(const Event& other) const { return place != other.place ? place < other.place : face < other.face; }
};

// Which side of the edge from a to b the point is on, and how far: twice the area. The same number but for its sign
// from b to a, so that of two faces at an edge exactly one holds a point on it.
double side_of(const Vector2d& a, const Vector2d& b, const Vector2d& p) {
  return (b.x() - a.x()) * (p.y() - a.y()) - (b.y() - a.y()) * (p.x() - a.x());
}

struct EdgeSide {
  double area;
  bool left;
};

EdgeSide edge_side(int from, int to, const Vector2d& a, const Vector2d& b, const Vector2d& p) {
  if (from < to) {
    const double area = side_of(a, b, p);
    return {area, area >= 0};
  }
  const double area = side_of(b, a, p);
  return {-area, !(area >= 0)};
}

// All faces that the lines along one axis meet, line by line.
std::vector<std::vector<Event>> met_faces(const Mesh& mesh, const Points& vertices, int axis, int wide, int high) {
  std::vector<std::vector<Event>> lines(static_cast<std::size_t>(wide) * static_cast<std::size_t>(high));
  const int across = (axis + 1) % 3;
  const int up = (axis + 2) % 3;
  for (int f = 0; f < mesh.faces.rows(); ++f) {
    std::array<int, 3> corner{};
    std::array<Vector2d, 3> flat;
    std::array<double, 3> depth{};
    for (std::size_t k = 0; k < 3; ++k) {
      corner[k] = mesh.faces(f, static_cast<int>(k));
      flat[k] = {vertices(corner[k], across), vertices(corner[k], up)};
      depth[k] = vertices(corner[k], axis);
    }
    const Vector2d low = flat[0].cwiseMin(flat[1]).cwiseMin(flat[2]);
    const Vector2d top = flat[0].cwiseMax(flat[1]).cwiseMax(flat[2]);
    const int last_u = std::min(wide - 1, static_cast<int>(std::floor(top.x())));
    const int last_v = std::min(high - 1, static_cast<int>(std::floor(top.y())));
    for (int v = std::max(0, static_cast<int>(std::ceil(low.y()))); v <= last_v; ++v) {
      for (int u = std::max(0, static_cast<int>(std::ceil(low.x()))); u <= last_u; ++u) {
        const Vector2d p(u, v);
        std::array<EdgeSide, 3> sides{};  // opposite to corner k
        for (std::size_t k = 0; k < 3; ++k) {
          const std::size_t a = (k + 1) % 3;
          const std::size_t b = (k + 2) % 3;
          sides[k] = edge_side(corner[a], corner[b], flat[a], flat[b], p);
        }
        if (sides[0].left != sides[1].left || sides[1].left != sides[2].left) continue;
        const double area = sides[0].area + sides[1].area + sides[2].area;
        const double place =
            area != 0 ? (sides[0].area * depth[0] + sides[1].area * depth[1] + sides[2].area * depth[2]) / area
                      : (depth[0] + depth[1] + depth[2]) / 3;
        const std::size_t line =
            static_cast<std::size_t>(v) * static_cast<std::size_t>(wide) + static_cast<std::size_t>(u);
        lines[line].push_back({place, f, sides[0].left});
      }
    }
  }
  return lines;
}

// Follows a line through the parts; keeps where it enters and leaves their union.
class LineWalker {
 public:
  explicit LineWalker(const ClosedParts& parts) : parts_(parts), winding_(parts.parity_of_part.size(), 0) {}

  std::vector<Crossing> operator()(std::vector<Event>& events) {
    std::sort(events.begin(), events.end());
    std::vector<Crossing> result;
    int inside = 0;  // parts
    for (const Event& event : events) {
      const auto part = static_cast<std::size_t>(parts_.part_of_face[static_cast<std::size_t>(event.face)]);
      const int before = winding_[part];
      const int after = parts_.parity_of_part[part] ? 1 - before : before + (event.leaves ? -1 : 1);
      winding_[part] = after;
      const bool was_inside = inside > 0;
      inside += (after != 0 ? 1 : 0) - (before != 0 ? 1 : 0);
      if (was_inside == (inside > 0)) continue;
      if (!result.empty() && event.place - result.back().place < kTouching) {
        result.pop_back();
      } else {
        result.push_back({event.place, event.face, was_inside});
      }
    }
    // Only rounding at a corner can leave a part open.
    for (const Event& event : events) {
      winding_[static_cast<std::size_t>(parts_.part_of_face[static_cast<std::size_t>(event.face)])] = 0;
    }
    if (result.size() % 2 != 0) result.pop_back();
    return result;
  }

 private:
  const ClosedParts& parts_;
  std::vector<int> winding_;
};

}  // namespace

UnionScan::UnionScan(const ClosedParts& parts, const Points& vertices, const std::array<int, 3>& nodes,
                     RunContext& context)
    : nodes_(nodes),
      inside_(static_cast<std::size_t>(nodes[0]) * static_cast<std::size_t>(nodes[1]) *
              static_cast<std::size_t>(nodes[2])) {
  const auto face_count = static_cast<std::size_t>(parts.mesh.faces.rows());
  std::vector<int> met(face_count, 0);
  std::vector<int> outer(face_count, 0);
  std::vector<int> against(face_count, 0);  // outer ones that the line leaves where the face says that it enters
  for (std::size_t axis = 0; axis < 3; ++axis) {
    context.progress("grid", static_cast<double>(axis) / 3);
    const auto wide = static_cast<std::size_t>(nodes[(axis + 1) % 3]);
    const auto high = static_cast<std::size_t>(nodes[(axis + 2) % 3]);
    std::vector<std::vector<Event>> events =
        met_faces(parts.mesh, vertices, static_cast<int>(axis), static_cast<int>(wide), static_cast<int>(high));
    std::vector<std::vector<Crossing>> lines(events.size());
    parallel_for(context, high, [&](std::size_t begin, std::size_t end) {
      LineWalker walker(parts);
      for (std::size_t line = begin * wide; line < end * wide; ++line) lines[line] = walker(events[line]);
    });
    first_of_line_[axis].push_back(0);
    for (std::size_t line = 0; line < lines.size(); ++line) {
      for (const Event& event : events[line]) {
        ++met[static_cast<std::size_t>(event.face)];
        const auto crossing = std::ranges::find(lines[line], event.face, &Crossing::face);
        if (crossing == lines[line].end()) continue;
        ++outer[static_cast<std::size_t>(event.face)];
        if (crossing->leaves != event.leaves) ++against[static_cast<std::size_t>(event.face)];
      }
      crossings_[axis].insert(crossings_[axis].end(), lines[line].begin(), lines[line].end());
      first_of_line_[axis].push_back(static_cast<int>(crossings_[axis].size()));
    }
  }
  for (int z = 0; z < nodes[2]; ++z) {
    for (int y = 0; y < nodes[1]; ++y) {
      const auto line = static_cast<std::size_t>(z) * static_cast<std::size_t>(nodes[1]) + static_cast<std::size_t>(y);
      for (int c = first_of_line_[0][line]; c + 1 < first_of_line_[0][line + 1]; c += 2) {
        const auto enter = static_cast<std::size_t>(c);
        const int first = std::max(0, static_cast<int>(std::ceil(crossings_[0][enter].place)));
        const int last = std::min(nodes[0] - 1, static_cast<int>(std::floor(crossings_[0][enter + 1].place)));
        for (int x = first; x <= last; ++x) inside_[node(x, y, z)] = 1;
      }
    }
  }
  fill_voids(inside_, nodes_);
  drop_crumbs(inside_, nodes_, kCrumb);
  // Faces too small to be met are turned as most of their part.
  std::vector<int> against_of_part(parts.parity_of_part.size(), 0);
  for (std::size_t f = 0; f < face_count; ++f) {
    against_of_part[static_cast<std::size_t>(parts.part_of_face[f])] += 2 * against[f] - outer[f];
  }
  for (std::size_t f = 0; f < face_count; ++f) {
    hidden_.push_back(met[f] > 0 && outer[f] == 0);
    turned_.push_back(outer[f] > 0 ? 2 * against[f] > outer[f]
                                   : against_of_part[static_cast<std::size_t>(parts.part_of_face[f])] > 0);
  }
}

Crossing UnionScan::crossing(int axis, const std::array<int, 3>& from) const {
  const auto a = static_cast<std::size_t>(axis);
  const auto line = static_cast<std::size_t>(from[(a + 2) % 3]) * static_cast<std::size_t>(nodes_[(a + 1) % 3]) +
                    static_cast<std::size_t>(from[(a + 1) % 3]);
  const bool leaves = inside(from[0], from[1], from[2]);
  const double low = from[a];
  // Several where a sheet or a gap is thinner than the cell: the one nearest to the outer node, which keeps the
  // outline. None where rounding puts a node on different sides of the surface for two axes: the nearest on the line.
  const double outer = leaves ? low + 1 : low;
  Crossing best{low + 0.5, -1, leaves};
  double best_distance = std::numeric_limits<double>::infinity();
  for (int c = first_of_line_[a][line]; c < first_of_line_[a][line + 1]; ++c) {
    const Crossing& candidate = crossings_[a][static_cast<std::size_t>(c)];
    if (candidate.leaves != leaves) continue;
    const bool within = candidate.place >= low && candidate.place <= low + 1;
    const double distance = std::abs(candidate.place - outer) + (within ? 0 : 2);
    if (distance >= best_distance) continue;
    best = candidate;
    best_distance = distance;
  }
  best.place = std::clamp(best.place, low, low + 1);
  return best;
}

}  // namespace orbifit

#include "remeshing/seams.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include <Eigen/Geometry>

#include "remeshing/curves.h"
#include "remeshing/indices.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;
using EdgeKey = std::pair<int, int>;

// One way along a curve, as it lies in the first curve's frame.
struct Side {
  std::vector<int> points;
  Polyline line;
};

class Sewing {
 public:
  Sewing(ClippedSurface& surface, const FiniteGroup& group, const FundamentalDomain& domain, double snap, double reach)
      : surface_(surface), group_(group), domain_(domain), snap_(snap), reach_(reach) {}

  Seams run() {
    find_border();
    pair_fixed_points();
    for (std::size_t w = 0; w < domain_.walls.size(); ++w) {
      const Wall& wall = domain_.walls[w];
      if (!wall.mirror && wall.partner >= static_cast<int>(w)) sew_wall(w);
    }
    return std::move(seams_);
  }

 private:
  const Motion& element(std::size_t wall) const { return group_.elements[at(domain_.walls[wall].element)]; }

  // Edges beyond which the surface goes on, each with all of its triangles.
  void find_border() {
    for (std::size_t t = 0; t < surface_.triangles.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        const EdgeKey edge = std::minmax(surface_.triangles[t][k], surface_.triangles[t][(k + 1) % 3]);
        if (surface_.continued.contains(edge)) border_[edge].push_back(static_cast<int>(t));
      }
    }
  }

  void pair_fixed_points() {
    const double rounding = 1e-6 * reach_;
    for (std::size_t v = 0; v < surface_.points.size(); ++v) {
      for (std::size_t w = 0; w < domain_.walls.size(); ++w) {
        if ((surface_.walls[v] & wall_bit(w)) == 0) continue;
        if ((element(w)(surface_.points[v]) - surface_.points[v]).norm() > rounding) continue;
        seams_.pairings.push_back({static_cast<int>(v), static_cast<int>(v), domain_.walls[w].element});
      }
    }
  }

  // The curves on a wall; of a wall that is its own partner those on one half.
  std::vector<WallCurve> curves_on(std::size_t w, int half) const {
    std::vector<std::array<int, 2>> edges;
    constexpr std::uint64_t all_walls = (std::uint64_t{1} << kMaxWalls) - 1;
    for (const auto& [edge, triangles] : border_) {
      const std::uint64_t walls = surface_.walls[at(edge.first)] & surface_.walls[at(edge.second)];
      // An edge on two walls lies on an axis, whose points are paired with themselves.
      if ((walls & all_walls) != wall_bit(w) || (walls & middle_bit(w)) != 0) continue;
      const Vector3d middle = (surface_.points[at(edge.first)] + surface_.points[at(edge.second)]) / 2;
      if (half * (middle - domain_.centre).dot(domain_.walls[w].half) < 0) continue;
      edges.push_back({edge.first, edge.second});
    }
    std::vector<char> node(surface_.points.size(), 0);
    for (std::size_t v = 0; v < node.size(); ++v) node[v] = (surface_.walls[v] & ~wall_bit(w)) != 0 ? 1 : 0;
    return curves_of(edges, node);
  }

  Polyline line(const WallCurve& curve, const Motion& motion) const {
    Polyline result;
    for (const int point : curve.points) result.push_back(motion(surface_.points[at(point)]));
    if (curve.closed) result.push_back(result.front());
    return result;
  }

  void sew_wall(std::size_t w) {
    const auto partner = at(domain_.walls[w].partner);
    const bool own = partner == w;
    const std::vector<WallCurve> here = curves_on(w, own ? 1 : 0);
    const std::vector<WallCurve> there = curves_on(partner, own ? -1 : 0);
    struct Match {
      double distance;
      std::size_t i, j;
    };
    std::vector<Match> matches;
    std::vector<Polyline> images;
    images.reserve(there.size());
    for (const WallCurve& curve : there) images.push_back(line(curve, element(w)));
    for (std::size_t i = 0; i < here.size(); ++i) {
      const Polyline original = line(here[i], Motion{});
      for (std::size_t j = 0; j < there.size(); ++j) {
        if (here[i].closed != there[j].closed) continue;
        const double distance = polyline_distance(original, images[j], reach_);
        if (distance <= reach_) matches.push_back({distance, i, j});
      }
    }
    std::ranges::stable_sort(matches, {}, &Match::distance);
    std::vector<char> used_here(here.size(), 0);
    std::vector<char> used_there(there.size(), 0);
    std::size_t sewn = 0;
    for (const Match& match : matches) {
      if (used_here[match.i] != 0 || used_there[match.j] != 0) continue;
      used_here[match.i] = used_there[match.j] = 1;
      ++sewn;
      sew_curves(w, here[match.i], there[match.j]);
    }
    seams_.unmatched += static_cast<int>(here.size() + there.size() - 2 * sewn);
  }

  Vector3d enclosed_area(const Polyline& closed) const {
    Vector3d area = Vector3d::Zero();
    for (std::size_t i = 1; i + 1 < closed.size(); ++i) {
      area += (closed[i] - closed[0]).cross(closed[i + 1] - closed[0]);
    }
    return area;
  }

  void sew_curves(std::size_t w, const WallCurve& here, const WallCurve& there) {
    Side a{here.points, line(here, Motion{})};
    Side b{there.points, line(there, element(w))};
    const auto reverse = [](Side& side) {
      std::ranges::reverse(side.points);
      std::ranges::reverse(side.line);
    };
    if (here.closed) {
      a.line.pop_back();
      b.line.pop_back();
      if (enclosed_area(a.line).dot(enclosed_area(b.line)) < 0) reverse(b);
      begin_together(a, b);
    } else {
      const double straight = (a.line.front() - b.line.front()).norm() + (a.line.back() - b.line.back()).norm();
      const double crossed = (a.line.front() - b.line.back()).norm() + (a.line.back() - b.line.front()).norm();
      if (crossed < straight) reverse(b);
    }
    const auto common = common_vertices(a.line, b.line, snap_);
    for (std::size_t c = 0; c + 1 < common.size(); ++c) {
      pair(a.points[at(common[c][0])], b.points[at(common[c][1])], w);
      merge(w, a, b, common[c], common[c + 1]);
    }
    pair(a.points.back(), b.points.back(), w);
  }

  // Both closed curves from the vertices that are nearest to one another, which are then repeated at their ends.
  static void begin_together(Side& a, Side& b) {
    std::size_t i0 = 0;
    std::size_t j0 = 0;
    double best = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < a.line.size(); ++i) {
      for (std::size_t j = 0; j < b.line.size(); ++j) {
        const double distance = (a.line[i] - b.line[j]).squaredNorm();
        if (distance < best) {
          best = distance;
          i0 = i;
          j0 = j;
        }
      }
    }
    const auto turn = [](Side& side, std::size_t first) {
      std::rotate(side.points.begin(), side.points.begin() + static_cast<std::ptrdiff_t>(first), side.points.end());
      std::rotate(side.line.begin(), side.line.begin() + static_cast<std::ptrdiff_t>(first), side.line.end());
      side.points.push_back(side.points.front());
      side.line.push_back(side.line.front());
    };
    turn(a, i0);
    turn(b, j0);
  }

  void pair(int point, int other, std::size_t w) {
    seams_.pairings.push_back({point, other, domain_.walls[w].element});
  }

  static std::vector<double> shares(const Polyline& line, int first, int last) {
    std::vector<double> result{0};
    for (int i = first; i < last; ++i) result.push_back(result.back() + (line[at(i + 1)] - line[at(i)]).norm());
    const double length = result.back();
    for (double& share : result) share = length > 0 ? share / length : 0;
    result.back() = 1;
    return result;
  }

  // Between two common vertices: each side gets the other's vertices at the same share of the length.
  void merge(std::size_t w, const Side& a, const Side& b, const std::array<int, 2>& from,
             const std::array<int, 2>& to) {
    const std::vector<double> s = shares(a.line, from[0], to[0]);
    const std::vector<double> t = shares(b.line, from[1], to[1]);
    std::size_t i = 1;
    std::size_t j = 1;
    int last_a = a.points[at(from[0])];
    int last_b = b.points[at(from[1])];
    double share = 0;
    while (i + 1 < s.size() || j + 1 < t.size()) {
      const double gap = std::abs(s[i] - t[j]);
      const double least = std::min({s[i] - s[i - 1], t[j] - t[j - 1]});
      const bool both = i + 1 < s.size() && j + 1 < t.size() && gap <= snap_ * least;
      const double next = both ? (s[i] + t[j]) / 2 : std::min(s[i], t[j]);
      const bool at_a = both || (i + 1 < s.size() && (s[i] <= t[j] || j + 1 >= t.size()));
      const int next_a = a.points[at(from[0]) + i];
      const int next_b = b.points[at(from[1]) + j];
      last_a = at_a ? next_a : split(last_a, next_a, (next - share) / std::max(s[i] - share, 1e-300));
      last_b = !at_a || both ? next_b : split(last_b, next_b, (next - share) / std::max(t[j] - share, 1e-300));
      pair(last_a, last_b, w);
      i += at_a ? 1 : 0;
      j += !at_a || both ? 1 : 0;
      share = next;
    }
  }

  // Puts a vertex into an edge of the border.
  int split(int a, int b, double share) {
    const int point = static_cast<int>(surface_.points.size());
    surface_.points.emplace_back(surface_.points[at(a)] +
                                 std::clamp(share, 0.0, 1.0) * (surface_.points[at(b)] - surface_.points[at(a)]));
    surface_.walls.push_back(surface_.walls[at(a)] & surface_.walls[at(b)]);
    surface_.cut.push_back(2);
    const auto entry = border_.find(std::minmax(a, b));
    if (entry == border_.end()) return point;
    const std::vector<int> triangles = std::move(entry->second);
    border_.erase(entry);
    const std::uint64_t walls = surface_.continued[std::minmax(a, b)];
    surface_.continued[std::minmax(a, point)] = walls;
    surface_.continued[std::minmax(point, b)] = walls;
    for (const int triangle : triangles) {
      const std::array<int, 3> old = surface_.triangles[at(triangle)];
      const int added = static_cast<int>(surface_.triangles.size());
      std::array<int, 3> first = old;
      std::array<int, 3> second = old;
      std::ranges::replace(first, b, point);
      std::ranges::replace(second, a, point);
      surface_.triangles[at(triangle)] = first;
      surface_.triangles.push_back(second);
      surface_.sources.push_back(surface_.sources[at(triangle)]);
      for (const int corner : old) {
        if (corner == a || corner == b) continue;
        if (const auto other = border_.find(std::minmax(b, corner)); other != border_.end()) {
          std::ranges::replace(other->second, triangle, added);
        }
      }
      border_[std::minmax(a, point)].push_back(triangle);
      border_[std::minmax(point, b)].push_back(added);
    }
    return point;
  }

  ClippedSurface& surface_;
  const FiniteGroup& group_;
  const FundamentalDomain& domain_;
  double snap_, reach_;
  std::map<EdgeKey, std::vector<int>> border_;
  Seams seams_;
};

}  // namespace

Seams sew(ClippedSurface& surface, const FiniteGroup& group, const FundamentalDomain& domain, double snap,
          double reach) {
  return Sewing(surface, group, domain, snap, reach).run();
}

}  // namespace orbifit

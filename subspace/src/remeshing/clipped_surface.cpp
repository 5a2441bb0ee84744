#include "remeshing/clipped_surface.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <unordered_map>
#include <utility>

#include <Eigen/Geometry>

#include "remeshing/indices.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;
using Corners = std::array<int, 3>;

Vector3d area_vector(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  return (b - a).cross(c - a) / 2;
}

std::vector<std::vector<int>> triangles_of_points(const ClippedSurface& surface) {
  std::vector<std::vector<int>> result(surface.points.size());
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    for (const int corner : surface.triangles[t]) result[at(corner)].push_back(static_cast<int>(t));
  }
  return result;
}

// Cuts along one plane through the domain's centre.
class PlaneCut {
 public:
  PlaneCut(ClippedSurface& surface, const FundamentalDomain& domain, const Cut& cut, Vector3d normal, std::uint64_t bit)
      : surface_(surface), domain_(domain), cut_(cut), normal_(std::move(normal)), bit_(bit) {
    for (const Vector3d& point : surface.points) heights_.push_back(height(point));
    within_.resize(surface.points.size(), 0);
    for (std::size_t v = 0; v < surface.points.size(); ++v) {
      if (std::abs(heights_[v]) > cut_.rounding) continue;
      within_[v] = 1;
      put_on(static_cast<int>(v), surface.points[v]);
    }
  }

  // Moves what is almost on the plane onto it along edges; `only`: walls that both ends must lie on.
  void snap(std::uint64_t only) {
    const std::vector<std::vector<int>> around = triangles_of_points(surface_);
    struct Move {
      double error = std::numeric_limits<double>::infinity();
      Vector3d to;
    };
    std::map<int, Move> moves;
    for (const Corners& corners : surface_.triangles) {
      for (std::size_t k = 0; k < 3; ++k) {
        for (const auto& [a, b] :
             {std::pair(corners[k], corners[(k + 1) % 3]), std::pair(corners[(k + 1) % 3], corners[k])}) {
          if (heights_[at(a)] * heights_[at(b)] >= 0) continue;
          const std::uint64_t walls = surface_.walls[at(a)];
          if ((surface_.walls[at(b)] & walls) != walls || (walls & surface_.walls[at(b)] & only) != only) continue;
          const double t = heights_[at(a)] / (heights_[at(a)] - heights_[at(b)]);
          if (t >= cut_.snap) continue;
          const Vector3d to = surface_.points[at(a)] + t * (surface_.points[at(b)] - surface_.points[at(a)]);
          const double error = out_of_plane(around[at(a)], to - surface_.points[at(a)]);
          Move& move = moves[a];
          if (error < move.error) move = {error, to};
        }
      }
    }
    for (const auto& [vertex, move] : moves) {
      if (move.error <= cut_.reach && !turns_over(around[at(vertex)], vertex, move.to)) put_on(vertex, move.to);
    }
  }

  // \param owner  of a triangle within the plane: whether it is kept
  template <class Owner>
  void keep_below(const Owner& owner) {
    std::vector<Corners> old = std::move(surface_.triangles);
    std::vector<int> sources = std::move(surface_.sources);
    surface_.triangles.clear();
    surface_.sources.clear();
    for (std::size_t t = 0; t < old.size(); ++t) {
      if (lies_within(old[t]) && owner(old[t])) {
        add(old[t], sources[t]);
      } else {
        add_part_below(old[t], sources[t]);
      }
    }
  }

  // Puts a vertex into every edge on a wall that crosses the plane.
  void split_edges(std::uint64_t wall) {
    const std::size_t count = surface_.triangles.size();
    for (std::size_t t = 0; t < count; ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        const int a = surface_.triangles[t][k];
        const int b = surface_.triangles[t][(k + 1) % 3];
        if ((surface_.walls[at(a)] & surface_.walls[at(b)] & wall) == 0) continue;
        if (heights_[at(a)] * heights_[at(b)] >= 0) continue;
        const auto before = surface_.points.size();
        const int point = crossing(a, b);
        if (surface_.points.size() == before) continue;  // of an edge inside, split from the other side
        // Every triangle at the edge.
        for (std::size_t other = surface_.triangles.size(); other-- > 0;) {
          Corners& corners = surface_.triangles[other];
          for (std::size_t j = 0; j < 3; ++j) {
            const int p = corners[j];
            const int q = corners[(j + 1) % 3];
            if (std::minmax(p, q) != std::minmax(a, b)) continue;
            Corners second = corners;
            second[j] = point;
            corners[(j + 1) % 3] = point;
            surface_.triangles.push_back(second);
            surface_.sources.push_back(surface_.sources[other]);
            break;
          }
        }
        break;
      }
    }
  }

 private:
  double height(const Vector3d& point) const { return normal_.dot(point - domain_.centre); }

  // The nearest point on all walls of a set.
  Vector3d onto(std::uint64_t walls, const Vector3d& point) const {
    Vector3d offset = point - domain_.centre;
    std::vector<Vector3d> basis;
    const auto add = [&](Vector3d normal) {
      for (const Vector3d& other : basis) normal -= other.dot(normal) * other;
      if (normal.norm() < 1e-6) return;  // of unit vectors: the same plane, or line, again
      basis.push_back(normal.normalized());
    };
    for (std::size_t w = 0; w < domain_.walls.size(); ++w) {
      if ((walls & wall_bit(w)) != 0) add(domain_.walls[w].normal);
      if ((walls & middle_bit(w)) != 0) add(domain_.walls[w].half);
    }
    for (const Vector3d& direction : basis) offset -= direction.dot(offset) * direction;
    for (const Vector3d& direction : basis) offset -= direction.dot(offset) * direction;
    return domain_.centre + offset;
  }

  void put_on(int vertex, const Vector3d& point) {
    surface_.walls[at(vertex)] |= bit_;
    surface_.points[at(vertex)] = onto(surface_.walls[at(vertex)], point);
    heights_[at(vertex)] = 0;
  }

  double out_of_plane(const std::vector<int>& triangles, const Vector3d& step) const {
    double error = 0;
    for (const int t : triangles) {
      const Corners& c = surface_.triangles[at(t)];
      const Vector3d normal =
          area_vector(surface_.points[at(c[0])], surface_.points[at(c[1])], surface_.points[at(c[2])]);
      if (normal.norm() > 0) error = std::max(error, std::abs(normal.normalized().dot(step)));
    }
    return error;
  }

  bool turns_over(const std::vector<int>& triangles, int vertex, const Vector3d& to) const {
    return std::ranges::any_of(triangles, [&](int t) {
      Corners c = surface_.triangles[at(t)];
      std::array<Vector3d, 3> p{surface_.points[at(c[0])], surface_.points[at(c[1])], surface_.points[at(c[2])]};
      const Vector3d before = area_vector(p[0], p[1], p[2]);
      for (std::size_t k = 0; k < 3; ++k) {
        if (c[k] == vertex) p[k] = to;
      }
      const bool all_on = std::ranges::all_of(c, [&](int v) { return v == vertex || heights_[at(v)] == 0; });
      return !all_on && area_vector(p[0], p[1], p[2]).dot(before) <= 0;
    });
  }

  int crossing(int a, int b) {
    const auto [low, high] = std::minmax(a, b);
    const std::uint64_t key = (static_cast<std::uint64_t>(low) << 32) | static_cast<std::uint32_t>(high);
    const auto [entry, added] = crossings_.try_emplace(key, static_cast<int>(surface_.points.size()));
    if (!added) return entry->second;
    const double t = heights_[at(low)] / (heights_[at(low)] - heights_[at(high)]);
    const std::uint64_t walls = (surface_.walls[at(low)] & surface_.walls[at(high)]) | bit_;
    surface_.points.push_back(
        onto(walls, surface_.points[at(low)] + t * (surface_.points[at(high)] - surface_.points[at(low)])));
    surface_.walls.push_back(walls);
    surface_.cut.push_back(1);
    heights_.push_back(0);
    inherit(low, high, entry->second);
    return entry->second;
  }

  // What was known of an edge holds of its halves.
  void inherit(int a, int b, int point) {
    const auto known = surface_.continued.find(std::minmax(a, b));
    if (known == surface_.continued.end()) return;
    const std::uint64_t walls = known->second;
    surface_.continued[std::minmax(a, point)] |= walls;
    surface_.continued[std::minmax(point, b)] |= walls;
  }

  // Whether a triangle was in the plane before anything was moved onto it.
  bool lies_within(const Corners& corners) const {
    return std::ranges::all_of(corners, [&](int v) { return at(v) < within_.size() && within_[at(v)] != 0; });
  }

  void goes_on(int a, int b) { surface_.continued[std::minmax(a, b)] |= bit_; }

  void add(const Corners& corners, int source) {
    surface_.triangles.push_back(corners);
    surface_.sources.push_back(source);
  }

  // What of a triangle is below; where something of it is not, the edge on the plane is noted.
  void add_part_below(const Corners& corners, int source) {
    int below = 0;
    int above = 0;
    for (const int corner : corners) {
      below += heights_[at(corner)] < 0 ? 1 : 0;
      above += heights_[at(corner)] > 0 ? 1 : 0;
    }
    if (below > 0 && above == 0) {
      add(corners, source);
      return;
    }
    if (below == 0) {
      for (std::size_t k = 0; k < 3; ++k) {
        const int a = corners[k];
        const int b = corners[(k + 1) % 3];
        if (heights_[at(a)] == 0 && heights_[at(b)] == 0) goes_on(a, b);
      }
      return;
    }
    std::vector<int> polygon;
    for (std::size_t k = 0; k < 3; ++k) {
      const int a = corners[k];
      const int b = corners[(k + 1) % 3];
      if (heights_[at(a)] <= 0) polygon.push_back(a);
      if (heights_[at(a)] * heights_[at(b)] < 0) polygon.push_back(crossing(a, b));
    }
    std::vector<int> on_plane;
    std::ranges::copy_if(polygon, std::back_inserter(on_plane), [&](int v) { return heights_[at(v)] == 0; });
    if (on_plane.size() == 2) goes_on(on_plane[0], on_plane[1]);
    const auto length = [&](std::size_t i, std::size_t j) {
      return (surface_.points[at(polygon[i])] - surface_.points[at(polygon[j])]).norm();
    };
    if (polygon.size() == 4 && length(1, 3) < length(0, 2))
      std::rotate(polygon.begin(), polygon.begin() + 1, polygon.end());
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i) add({polygon[0], polygon[i], polygon[i + 1]}, source);
  }

  ClippedSurface& surface_;
  const FundamentalDomain& domain_;
  const Cut& cut_;
  Vector3d normal_;
  std::uint64_t bit_;
  std::vector<double> heights_;
  std::vector<char> within_;  // by vertex: on the plane from the beginning
  std::unordered_map<std::uint64_t, int> crossings_;
};

}  // namespace

void clip(ClippedSurface& surface, const FundamentalDomain& domain, const Cut& cut) {
  for (std::size_t w = 0; w < domain.walls.size(); ++w) {
    PlaneCut plane(surface, domain, cut, domain.walls[w].normal, wall_bit(w));
    plane.snap(0);
    const Wall& wall = domain.walls[w];
    plane.keep_below([&](const std::array<int, 3>& corners) {
      if (wall.mirror || wall.partner > static_cast<int>(w)) return true;
      if (wall.partner < static_cast<int>(w)) return false;
      Vector3d middle = Vector3d::Zero();
      for (const int corner : corners) middle += (surface.points[at(corner)] - domain.centre) / 3;
      return middle.dot(wall.half) > 0;
    });
  }
  for (std::size_t w = 0; w < domain.walls.size(); ++w) {
    if (domain.walls[w].half.isZero()) continue;
    PlaneCut plane(surface, domain, cut, domain.walls[w].half, middle_bit(w));
    plane.snap(wall_bit(w));
    plane.split_edges(wall_bit(w));
  }
}

}  // namespace orbifit

#include "remeshing/curves.h"

#include <algorithm>
#include <limits>
#include <map>
#include <set>

#include <Eigen/Geometry>

namespace orbifit {

namespace {

using Eigen::Vector3d;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double segment_distance(const Vector3d& p, const Vector3d& a, const Vector3d& b) {
  const Vector3d d = b - a;
  const double t = d.squaredNorm() > 0 ? std::clamp((p - a).dot(d) / d.squaredNorm(), 0.0, 1.0) : 0.0;
  return (p - a - t * d).norm();
}

double one_sided(const Polyline& a, const Polyline& b) {
  double worst = 0;
  for (const Vector3d& p : a) {
    double nearest = (p - b.front()).norm();
    for (std::size_t i = 0; i + 1 < b.size(); ++i) nearest = std::min(nearest, segment_distance(p, b[i], b[i + 1]));
    worst = std::max(worst, nearest);
  }
  return worst;
}

Eigen::AlignedBox3d box(const Polyline& line) {
  Eigen::AlignedBox3d result;
  for (const Vector3d& point : line) result.extend(point);
  return result;
}

std::size_t nearest_vertex(const Vector3d& p, const Polyline& line) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < line.size(); ++i) {
    if ((line[i] - p).squaredNorm() < (line[best] - p).squaredNorm()) best = i;
  }
  return best;
}

double shortest_edge(const Polyline& line, std::size_t i) {
  double length = kInfinity;
  if (i > 0) length = std::min(length, (line[i] - line[i - 1]).norm());
  if (i + 1 < line.size()) length = std::min(length, (line[i + 1] - line[i]).norm());
  return length;
}

// The longest chain that ascends in the second number; the first ones ascend already.
std::vector<std::array<int, 2>> longest_ascent(const std::vector<std::array<int, 2>>& pairs) {
  std::vector<int> length(pairs.size(), 1);
  std::vector<int> before(pairs.size(), -1);
  std::size_t last = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (pairs[j][1] < pairs[i][1] && length[j] + 1 > length[i]) {
        length[i] = length[j] + 1;
        before[i] = static_cast<int>(j);
      }
    }
    if (length[i] > length[last]) last = i;
  }
  std::vector<std::array<int, 2>> chain;
  for (int i = pairs.empty() ? -1 : static_cast<int>(last); i >= 0; i = before[static_cast<std::size_t>(i)]) {
    chain.push_back(pairs[static_cast<std::size_t>(i)]);
  }
  std::ranges::reverse(chain);
  return chain;
}

}  // namespace

std::vector<WallCurve> curves_of(const std::vector<std::array<int, 2>>& edges, const std::vector<char>& node) {
  std::map<int, std::vector<int>> neighbours;
  for (const auto& [a, b] : edges) {
    neighbours[a].push_back(b);
    neighbours[b].push_back(a);
  }
  const auto ends = [&](int point) {
    return node[static_cast<std::size_t>(point)] != 0 || neighbours.at(point).size() != 2;
  };
  std::set<std::array<int, 2>> done;
  std::vector<WallCurve> curves;
  const auto follow = [&](int from, int to) {
    WallCurve curve{{from}, false};
    while (done.insert({from, to}).second) {
      done.insert({to, from});
      if (to == curve.points.front() && !ends(to)) {
        curve.closed = true;
        break;
      }
      curve.points.push_back(to);
      if (ends(to)) break;
      const std::vector<int>& both = neighbours.at(to);
      const int next = both[0] == from ? both[1] : both[0];
      from = to;
      to = next;
    }
    curves.push_back(std::move(curve));
  };
  for (const auto& [point, others] : neighbours) {
    if (!ends(point)) continue;
    for (const int other : others) {
      if (!done.contains({point, other})) follow(point, other);
    }
  }
  for (const auto& [point, others] : neighbours) {
    if (!done.contains({point, others.front()})) follow(point, others.front());
  }
  return curves;
}

double polyline_distance(const Polyline& a, const Polyline& b, double reach) {
  const Eigen::AlignedBox3d box_a = box(a);
  const Eigen::AlignedBox3d box_b = box(b);
  if ((box_a.min() - box_b.min()).cwiseAbs().maxCoeff() > reach ||
      (box_a.max() - box_b.max()).cwiseAbs().maxCoeff() > reach) {
    return kInfinity;
  }
  return std::max(one_sided(a, b), one_sided(b, a));
}

std::vector<std::array<int, 2>> common_vertices(const Polyline& a, const Polyline& b, double snap) {
  const int last_a = static_cast<int>(a.size()) - 1;
  const int last_b = static_cast<int>(b.size()) - 1;
  std::vector<std::array<int, 2>> inner;
  for (std::size_t i = 1; i + 1 < a.size(); ++i) {
    const std::size_t j = nearest_vertex(a[i], b);
    if (j == 0 || j + 1 == b.size() || nearest_vertex(b[j], a) != i) continue;
    if ((a[i] - b[j]).norm() > snap * std::min(shortest_edge(a, i), shortest_edge(b, j))) continue;
    inner.push_back({static_cast<int>(i), static_cast<int>(j)});
  }
  std::vector<std::array<int, 2>> result{{0, 0}};
  for (const auto& pair : longest_ascent(inner)) result.push_back(pair);
  result.push_back({last_a, last_b});
  return result;
}

}  // namespace orbifit

#include "orbifit/detection/segments.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <vector>

namespace orbifit {

namespace {

// Union-find whose roots are the lowest members.
class Sets {
 public:
  explicit Sets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }

  int root(int member) {
    while (parent_[static_cast<std::size_t>(member)] != member) {
      int& parent = parent_[static_cast<std::size_t>(member)];
      parent = parent_[static_cast<std::size_t>(parent)];
      member = parent;
    }
    return member;
  }

  void unite(int a, int b) {
    const int first = root(a);
    const int second = root(b);
    parent_[static_cast<std::size_t>(std::max(first, second))] = std::min(first, second);
  }

 private:
  std::vector<int> parent_;
};

double edge_length(const PreparedMesh& prepared, const Edge& edge) {
  const auto place = [&](int k) {
    return prepared.mesh.vertices.row(
        prepared.weld.representative[static_cast<std::size_t>(edge.vertices[static_cast<std::size_t>(k)])]);
  };
  return (place(1) - place(0)).norm();
}

// Segments too small to say anything join the neighbour along the longest common border, smallest first.
void absorb_slivers(const PreparedMesh& prepared, const std::vector<Edge>& edges, double least_area, Sets& sets) {
  constexpr int kRounds = 4;
  const auto faces = static_cast<std::size_t>(prepared.mesh.faces.rows());
  for (int round = 0; round < kRounds; ++round) {
    std::vector<double> area(faces, 0);
    for (std::size_t f = 0; f < faces; ++f) {
      area[static_cast<std::size_t>(sets.root(static_cast<int>(f)))] += prepared.areas[static_cast<Eigen::Index>(f)];
    }
    std::map<std::pair<int, int>, double> borders;  // (small segment, neighbour): common length
    for (const Edge& edge : edges) {
      if (edge.faces.size() != 2) continue;
      const int a = sets.root(edge.faces[0]);
      const int b = sets.root(edge.faces[1]);
      if (a == b) continue;
      const double length = edge_length(prepared, edge);
      if (area[static_cast<std::size_t>(a)] < least_area) borders[{a, b}] += length;
      if (area[static_cast<std::size_t>(b)] < least_area) borders[{b, a}] += length;
    }
    if (borders.empty()) return;
    std::map<int, std::pair<double, int>> choice;
    for (const auto& [pair, length] : borders) {
      auto& best = choice.try_emplace(pair.first, -1.0, -1).first->second;
      if (length > best.first) best = {length, pair.second};
    }
    for (const auto& [segment, best] : choice) sets.unite(segment, best.second);
  }
}

}  // namespace

Components smooth_segments(const PreparedMesh& prepared, const SegmentOptions& options) {
  const auto count = static_cast<std::size_t>(prepared.mesh.faces.rows());
  const double cosine = std::cos(options.crease * std::numbers::pi / 180);
  const std::vector<Edge> edges = welded_edges(prepared.mesh, prepared.weld);
  Sets sets(count);
  std::vector<char> joined(count, 0);
  for (const Edge& edge : edges) {
    // Repeated faces lie on one another: the sheet goes on on both.
    std::vector<int> visible;
    std::vector<int> hidden;
    for (const int f : edge.faces) (prepared.areas[f] > 0 ? visible : hidden).push_back(f);
    for (const int f : hidden) {
      if (joined[static_cast<std::size_t>(f)] != 0) continue;  // once: it must not bridge a crease
      sets.unite(f, visible.empty() ? edge.faces.front() : visible.front());
      joined[static_cast<std::size_t>(f)] = visible.empty() ? 0 : 1;
    }
    if (visible.size() != 2) continue;
    const Eigen::Vector3d first = prepared.normals.row(visible[0]);
    if (std::abs(first.dot(prepared.normals.row(visible[1]))) >= cosine) sets.unite(visible[0], visible[1]);
  }
  absorb_slivers(prepared, edges, options.least_share * prepared.area, sets);

  Components result;
  result.component_of_face.assign(count, -1);
  std::vector<int> number(count, -1);
  for (std::size_t f = 0; f < count; ++f) {
    int& segment = number[static_cast<std::size_t>(sets.root(static_cast<int>(f)))];
    if (segment < 0) {
      segment = static_cast<int>(result.faces.size());
      result.faces.emplace_back();
    }
    result.component_of_face[f] = segment;
    result.faces[static_cast<std::size_t>(segment)].push_back(static_cast<int>(f));
  }
  return result;
}

}  // namespace orbifit

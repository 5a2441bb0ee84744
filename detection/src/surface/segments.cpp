#include "surface/segments.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <numbers>
#include <vector>

#include "base/disjoint_sets.h"

namespace orbifit {

namespace {

// Where one end of the edge is.
Eigen::Vector3d end_of(const PreparedMesh& prepared, const Edge& edge, std::size_t k) {
  return prepared.mesh.vertices.row(prepared.weld.representative[static_cast<std::size_t>(edge.vertices[k])]);
}

double edge_length(const PreparedMesh& prepared, const Edge& edge) {
  return (end_of(prepared, edge, 1) - end_of(prepared, edge, 0)).norm();
}

// The faces at the edge that count: no repeated ones, none without area.
std::vector<int> visible_faces(const PreparedMesh& prepared, const Edge& edge) {
  std::vector<int> result;
  std::ranges::copy_if(edge.faces, std::back_inserter(result), [&](int f) { return prepared.areas[f] > 0; });
  return result;
}

// From the edge across the face, to its third corner.
Eigen::Vector3d across(const PreparedMesh& prepared, const Edge& edge, int face) {
  const Eigen::Vector3d start = end_of(prepared, edge, 0);
  const Eigen::Vector3d along = end_of(prepared, edge, 1) - start;
  for (int k = 0; k < 3; ++k) {
    const int corner = prepared.mesh.faces(face, k);
    const int group = prepared.weld.group_of_vertex[static_cast<std::size_t>(corner)];
    if (group == edge.vertices[0] || group == edge.vertices[1]) continue;
    const Eigen::Vector3d to = prepared.mesh.vertices.row(corner).transpose() - start;
    return to - along * (along.dot(to) / along.squaredNorm());
  }
  return Eigen::Vector3d::Zero();
}

// Whether the surface goes on smoothly over the edge, however its two faces are oriented: not so where it folds back,
// as at a knife's edge, although its normals are nearly parallel there.
bool smooth_across(const PreparedMesh& prepared, const Edge& edge, int first, int second, double cosine) {
  if (std::abs(prepared.normals.row(first).dot(prepared.normals.row(second))) < cosine) return false;
  return across(prepared, edge, first).dot(across(prepared, edge, second)) <= 0;
}

std::array<int, 3> corners_of(const PreparedMesh& prepared, int face) {
  std::array<int, 3> corners{};
  for (int k = 0; k < 3; ++k) {
    corners[static_cast<std::size_t>(k)] =
        prepared.weld.group_of_vertex[static_cast<std::size_t>(prepared.mesh.faces(face, k))];
  }
  std::ranges::sort(corners);
  return corners;
}

// Joins each face without area to one neighbour, and no more, so that none bridges a crease. What has the same corners
// as an earlier face joins it: the sheet goes on on both.
void join_without_area(const PreparedMesh& prepared, const std::vector<Edge>& edges, DisjointSets& sets) {
  const auto count = static_cast<int>(prepared.mesh.faces.rows());
  std::vector<char> joined(static_cast<std::size_t>(count), 0);
  std::map<std::array<int, 3>, int> first_with;
  for (int f = 0; f < count; ++f) {
    joined[static_cast<std::size_t>(f)] = prepared.areas[f] > 0 ? 1 : 0;
    const auto [known, fresh] = first_with.try_emplace(corners_of(prepared, f), f);
    if (fresh) continue;
    sets.unite(f, known->second);
    joined[static_cast<std::size_t>(f)] = 1;
  }
  const auto join = [&](int face, const Edge& edge) {
    const auto neighbour =
        std::ranges::find_if(edge.faces, [&](int f) { return joined[static_cast<std::size_t>(f)] != 0; });
    if (neighbour == edge.faces.end()) return false;
    sets.unite(face, *neighbour);
    joined[static_cast<std::size_t>(face)] = 1;
    return true;
  };
  // Next to one another they follow in turn.
  for (bool more = true; more;) {
    more = false;
    for (const Edge& edge : edges) {
      for (const int f : edge.faces) {
        if (joined[static_cast<std::size_t>(f)] == 0 && join(f, edge)) more = true;
      }
    }
  }
  // A face with two corners at one place is at no edge of the welded mesh, but lies on one.
  for (int f = 0; f < count; ++f) {
    if (joined[static_cast<std::size_t>(f)] != 0) continue;
    const std::array<int, 3> corners = corners_of(prepared, f);
    const std::array<int, 2> ends{corners[0], corners[2]};
    const auto edge = std::ranges::lower_bound(edges, ends, {}, &Edge::vertices);
    if (edge != edges.end() && edge->vertices == ends) join(f, *edge);
  }
}

// Segments too small to say anything join the neighbour along the longest common border, smallest first.
void absorb_slivers(const PreparedMesh& prepared, const std::vector<Edge>& edges, double least_area,
                    DisjointSets& sets) {
  constexpr int kRounds = 4;
  const auto faces = static_cast<std::size_t>(prepared.mesh.faces.rows());
  for (int round = 0; round < kRounds; ++round) {
    std::vector<double> area(faces, 0);
    for (std::size_t f = 0; f < faces; ++f) {
      area[static_cast<std::size_t>(sets.root(static_cast<int>(f)))] += prepared.areas[static_cast<Eigen::Index>(f)];
    }
    std::map<std::pair<int, int>, double> borders;  // (small segment, neighbour): common length
    for (const Edge& edge : edges) {
      const std::vector<int> visible = visible_faces(prepared, edge);
      if (visible.size() != 2) continue;
      const int a = sets.root(visible[0]);
      const int b = sets.root(visible[1]);
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
  DisjointSets sets(count);
  std::vector<char> joined(count, 0);
  join_without_area(prepared, edges, sets);
  for (const Edge& edge : edges) {
    const std::vector<int> visible = visible_faces(prepared, edge);
    if (visible.size() == 2 && smooth_across(prepared, edge, visible[0], visible[1], cosine)) {
      sets.unite(visible[0], visible[1]);
    }
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

bool flat_piece(const PreparedMesh& prepared, const std::vector<int>& faces) {
  constexpr double kCosine = 0.9962;  // 5 degrees
  constexpr double kShare = 0.9;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const int f : faces) sum += prepared.areas[f] * prepared.normals.row(f).transpose();
  const Eigen::Vector3d way = sum.stableNormalized();
  double area = 0;
  double along = 0;
  for (const int f : faces) {
    area += prepared.areas[f];
    if (way.dot(prepared.normals.row(f)) >= kCosine) along += prepared.areas[f];
  }
  return area > 0 && along >= kShare * area;
}

}  // namespace orbifit

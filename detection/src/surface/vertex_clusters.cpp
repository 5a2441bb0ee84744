#include "surface/vertex_clusters.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numeric>
#include <utility>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "base/disjoint_sets.h"
#include "geometry/grid_cell.h"
#include "surface/thresholds.h"

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kCoarsest = 2;       // size of a cell of level 0, tolerances of the component
constexpr double kSmallest = 1e-12;   // cell, so that its numbers do not overflow
constexpr int kLevels = 5;            // beyond, each site is for itself
constexpr double kFlat = 0.1;         // root mean square distance from the planes, tolerances of the component
constexpr double kOneSided = 0.35;    // length of the mean normal: less, and both sides of something are in one cell
constexpr double kSmooth = 0.97;      // the same where there is no crease: none must arise
constexpr double kDetermined = 1e-3;  // of the largest eigenvalue: below, planes leave a direction open
constexpr double kFarthest = 0.8;     // of a place from the mean of its sites, in cells

}  // namespace

Sites::Sites(const PreparedMesh& prepared) : of_face(static_cast<std::size_t>(prepared.mesh.faces.rows())) {
  std::vector<int> first(prepared.weld.representative.size(), -1);
  std::map<std::pair<int, int>, int> others;  // (group, component): further components at a vertex
  for (std::size_t f = 0; f < of_face.size(); ++f) {
    const int in = prepared.components.component_of_face[f];
    for (int k = 0; k < 3; ++k) {
      const auto corner = static_cast<std::size_t>(prepared.mesh.faces(static_cast<Eigen::Index>(f), k));
      const int at = prepared.weld.group_of_vertex[corner];
      int* site = &first[static_cast<std::size_t>(at)];
      if (*site >= 0 && component[static_cast<std::size_t>(*site)] != in) {
        site = &others.try_emplace({at, in}, -1).first->second;
      }
      if (*site < 0) {
        *site = static_cast<int>(group.size());
        group.push_back(at);
        component.push_back(in);
      }
      of_face[f][static_cast<std::size_t>(k)] = *site;
    }
  }
}

// Squared distances from planes, weighted by area: x^T A x + 2 b^T x + c with x measured from `origin`.
struct VertexClustering::Quadric {
  Vector3d origin;  // the mean of the sites
  Matrix3d a = Matrix3d::Zero();
  Vector3d b = Vector3d::Zero();
  double c = 0;
  double weight = 0;
  Vector3d normals = Vector3d::Zero();  // of faces, times area
  double area = 0;

  void add(const Vector3d& normal, const Vector3d& point, double share) {
    const double offset = -normal.dot(point - origin);
    a += share * normal * normal.transpose();
    b += share * offset * normal;
    c += share * offset * offset;
    weight += share;
  }

  double distance(const Vector3d& point) const {
    const Vector3d x = point - origin;
    return std::sqrt(std::max(0.0, x.dot(a * x) + 2 * b.dot(x) + c) / std::max(weight, 1e-300));
  }

  // Nearest to all planes; where they leave directions open, or would lead out of reach, as near the mean of the sites
  // as can be.
  Vector3d minimiser(double reach) const {
    const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(a);
    const Vector3d values = solver.eigenvalues();
    Vector3d best = origin;
    Vector3d step = Vector3d::Zero();
    for (int k = 2; k >= 0 && values[k] > kDetermined * values[2]; --k) {
      step -= solver.eigenvectors().col(k).dot(b) / values[k] * solver.eigenvectors().col(k);
      if (step.norm() > reach) break;
      best = origin + step;
    }
    return best;
  }
};

VertexClustering::VertexClustering(const PreparedMesh& prepared, const Sites& sites, double tolerance, double noise)
    : prepared_(prepared),
      sites_(sites),
      rough_(kLeftOfNoise * noise),
      on_rim_(sites.group.size(), 0),
      at_crease_(sites.group.size(), 0) {
  std::vector<Eigen::AlignedBox3d> boxes(prepared.components.faces.size());
  for (std::size_t s = 0; s < sites.group.size(); ++s) {
    boxes[static_cast<std::size_t>(sites.component[s])].extend(place_of(static_cast<int>(s)));
  }
  for (const Eigen::AlignedBox3d& box : boxes) {
    tolerances_.push_back(tolerance_of_part(tolerance, box.isEmpty() ? 0 : box.diagonal().norm()));
  }
  find_creases();
  rims_.reserve(3 * sites.of_face.size());
  for (std::size_t f = 0; f < sites.of_face.size(); ++f) {
    if (prepared.areas[static_cast<Eigen::Index>(f)] <= 0) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(sites.of_face[f][k], sites.of_face[f][(k + 1) % 3]);
      rims_.push_back({low, high});
    }
  }
  std::ranges::sort(rims_);
  std::size_t kept = 0;
  for (std::size_t i = 0, end = 0; i < rims_.size(); i = end) {
    while (end < rims_.size() && rims_[end] == rims_[i]) ++end;
    if (end == i + 1) rims_[kept++] = rims_[i];
  }
  rims_.resize(kept);
  rims_.shrink_to_fit();
  for (const auto& [a, b] : rims_) {
    on_rim_[static_cast<std::size_t>(a)] = 1;
    on_rim_[static_cast<std::size_t>(b)] = 1;
  }
}

void VertexClustering::find_creases() {
  for (std::size_t s = 0; s < at_crease_.size(); ++s) {
    const std::vector<int>& around = prepared_.faces_of_vertex[static_cast<std::size_t>(sites_.group[s])];
    for (const int face : around) {
      for (const int other : around) {
        if (other <= face || std::abs(prepared_.normals.row(face).dot(prepared_.normals.row(other))) >= kAlikeNormals)
          continue;
        int common = 0;
        for (const int a : sites_.of_face[static_cast<std::size_t>(face)]) {
          for (const int b : sites_.of_face[static_cast<std::size_t>(other)]) common += a == b ? 1 : 0;
        }
        if (common == 2) at_crease_[s] = 1;
      }
    }
  }
}

Vector3d VertexClustering::place_of(int site) const {
  const auto group = static_cast<std::size_t>(sites_.group[static_cast<std::size_t>(site)]);
  return prepared_.mesh.vertices.row(prepared_.weld.representative[group]);
}

VertexClustering::Cell VertexClustering::cell_of(int site, int level) const {
  const auto component = static_cast<std::size_t>(sites_.component[static_cast<std::size_t>(site)]);
  const double size = std::max(std::ldexp(kCoarsest * tolerances_[component], -level), kSmallest);
  return grid_cell(place_of(site), size);
}

bool VertexClustering::at_border(int a, int b) const {
  const std::array<int, 2> ends{std::min(a, b), std::max(a, b)};
  return on_rim_[static_cast<std::size_t>(a)] != 0 && on_rim_[static_cast<std::size_t>(b)] != 0 &&
         std::ranges::binary_search(rims_, ends);
}

std::vector<std::vector<int>> VertexClustering::joined(const std::vector<int>& sites, int level) const {
  DisjointSets sets(sites.size());
  std::vector<Cell> cells;
  cells.reserve(sites.size());
  for (const int site : sites) cells.push_back(cell_of(site, level));
  for (std::size_t i = 0; i < sites.size(); ++i) {
    const auto group = static_cast<std::size_t>(sites_.group[static_cast<std::size_t>(sites[i])]);
    for (const int face : prepared_.faces_of_vertex[group]) {
      for (const int other : sites_.of_face[static_cast<std::size_t>(face)]) {
        if (other <= sites[i]) continue;
        const auto found = std::ranges::lower_bound(sites, other);
        if (found == sites.end() || *found != other) continue;
        const auto j = static_cast<std::size_t>(found - sites.begin());
        if (sites_.component[static_cast<std::size_t>(other)] == sites_.component[static_cast<std::size_t>(sites[i])] &&
            cells[i] == cells[j]) {
          sets.unite(static_cast<int>(i), static_cast<int>(j));
        }
      }
    }
  }
  std::vector<std::vector<int>> result;
  std::vector<int> number(sites.size(), -1);
  for (std::size_t i = 0; i < sites.size(); ++i) {
    int& set = number[static_cast<std::size_t>(sets.root(static_cast<int>(i)))];
    if (set < 0) {
      set = static_cast<int>(result.size());
      result.emplace_back();
    }
    result[static_cast<std::size_t>(set)].push_back(sites[i]);
  }
  return result;
}

VertexClustering::Quadric VertexClustering::quadric_of(const std::vector<int>& sites) const {
  Quadric quadric;
  quadric.origin.setZero();
  for (const int site : sites) quadric.origin += place_of(site) / static_cast<double>(sites.size());
  for (const int site : sites) {
    const Vector3d here = place_of(site);
    const auto number = static_cast<std::size_t>(site);
    for (const int face : prepared_.faces_of_vertex[static_cast<std::size_t>(sites_.group[number])]) {
      if (prepared_.components.component_of_face[static_cast<std::size_t>(face)] != sites_.component[number]) continue;
      const double area = prepared_.areas[face] / 3;
      const Vector3d normal = prepared_.normals.row(face);
      quadric.add(normal, here, area);
      quadric.normals += area * normal;
      quadric.area += area;
      if (on_rim_[number] == 0) continue;
      // Along a border the plane at right angles to the face, through the edge, keeps the border where it is.
      for (const int other : sites_.of_face[static_cast<std::size_t>(face)]) {
        if (other == site || !at_border(site, other)) continue;
        const Vector3d edge = place_of(other) - here;
        quadric.add(edge.cross(normal).normalized(), here, edge.squaredNorm() / 2);
      }
    }
  }
  return quadric;
}

void VertexClustering::merge(std::vector<int> sites, int level, std::vector<VertexCluster>& merged) const {
  if (sites.size() == 1 || level >= kLevels) {
    for (VertexCluster& each : singles(sites)) merged.push_back(std::move(each));
    return;
  }
  const double tolerance = tolerances_[static_cast<std::size_t>(sites_.component[static_cast<std::size_t>(sites[0])])];
  const Quadric quadric = quadric_of(sites);
  const Vector3d place = quadric.minimiser(kFarthest * std::ldexp(kCoarsest * tolerance, -level));
  const double aligned = std::ranges::any_of(sites, [&](int s) { return at_crease_[static_cast<std::size_t>(s)] != 0; })
                             ? kOneSided
                             : kSmooth;
  if (quadric.normals.norm() >= aligned * quadric.area && quadric.distance(place) <= kFlat * tolerance + rough_) {
    merged.push_back({std::move(sites), level, place});
    return;
  }
  for (std::vector<int>& part : joined(sites, level + 1)) merge(std::move(part), level + 1, merged);
}

std::vector<VertexCluster> VertexClustering::split(const VertexCluster& cluster) const {
  std::vector<VertexCluster> result;
  for (std::vector<int>& part : joined(cluster.sites, cluster.level + 1)) {
    merge(std::move(part), cluster.level + 1, result);
  }
  return result;
}

std::vector<VertexCluster> VertexClustering::singles(const std::vector<int>& sites) const {
  std::vector<VertexCluster> result;
  for (const int site : sites) result.push_back({{site}, kLevels, place_of(site)});
  return result;
}

std::vector<VertexCluster> VertexClustering::clusters(const RunContext& context) const {
  // Those of level 0 first, of all sites at once.
  const std::size_t count = sites_.group.size();
  std::vector<Cell> cells(count);
  parallel_for(context, count, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) cells[s] = cell_of(static_cast<int>(s), 0);
  });
  DisjointSets sets(count);
  for (const std::array<int, 3>& corners : sites_.of_face) {
    for (std::size_t k = 0; k < 3; ++k) {
      const int a = corners[k];
      const int b = corners[(k + 1) % 3];
      if (cells[static_cast<std::size_t>(a)] == cells[static_cast<std::size_t>(b)]) sets.unite(a, b);
    }
  }
  context.check();
  std::vector<std::vector<int>> first;
  std::vector<int> number(count, -1);
  for (std::size_t s = 0; s < count; ++s) {
    int& set = number[static_cast<std::size_t>(sets.root(static_cast<int>(s)))];
    if (set < 0) {
      set = static_cast<int>(first.size());
      first.emplace_back();
    }
    first[static_cast<std::size_t>(set)].push_back(static_cast<int>(s));
  }
  std::vector<std::vector<VertexCluster>> merged(first.size());
  parallel_for(context, first.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (i % 256 == 0) context.check();
      merge(std::move(first[i]), 0, merged[i]);
    }
  });
  std::vector<VertexCluster> result;
  for (std::vector<VertexCluster>& each : merged) {
    std::ranges::move(each, std::back_inserter(result));
  }
  return result;
}

}  // namespace orbifit

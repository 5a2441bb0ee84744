#include "orbifit/subspace/laplacian.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "orbifit/model/point_index.h"

namespace orbifit {

namespace {

// Distances that differ by less are the same up to rounding, between images of one pair.
constexpr double kSameDistance = 1e-9;

class Pieces {
 public:
  explicit Pieces(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }

  int find(int point) {
    while (parent_[static_cast<std::size_t>(point)] != point) {
      int& parent = parent_[static_cast<std::size_t>(point)];
      parent = parent_[static_cast<std::size_t>(parent)];
      point = parent;
    }
    return point;
  }

  bool join(int a, int b) {
    a = find(a);
    b = find(b);
    parent_[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
    return a != b;
  }

 private:
  std::vector<int> parent_;
};

// The pairs between different pieces at the least distance.
SampleEdges nearest_between_pieces(const Points& points, Pieces& pieces) {
  double least = std::numeric_limits<double>::infinity();
  std::vector<std::pair<double, std::pair<int, int>>> found;
  const int count = static_cast<int>(points.rows());
  for (int i = 0; i < count; ++i) {
    for (int j = i + 1; j < count; ++j) {
      if (pieces.find(i) == pieces.find(j)) continue;
      const double distance = (points.row(i) - points.row(j)).norm();
      if (distance > least * (1 + kSameDistance)) continue;
      least = std::min(least, distance);
      found.push_back({distance, {i, j}});
    }
  }
  SampleEdges result;
  for (const auto& [distance, pair] : found) {
    if (distance <= least * (1 + kSameDistance)) result.push_back(pair);
  }
  return result;
}

}  // namespace

SampleEdges neighbour_graph(const Points& points, double distance) {
  const int count = static_cast<int>(points.rows());
  SampleEdges edges;
  if (count == 0) return edges;
  const PointIndex index(points);
  Pieces pieces(static_cast<std::size_t>(count));
  int remaining = count;
  for (int i = 0; i < count; ++i) {
    for (const auto& [j, length] : index.within(points.row(i).transpose(), distance * (1 - kSameDistance))) {
      if (j <= i) continue;
      edges.emplace_back(i, j);
      if (pieces.join(i, j)) --remaining;
    }
  }
  while (remaining > 1) {
    for (const auto& [i, j] : nearest_between_pieces(points, pieces)) {
      edges.emplace_back(i, j);
      if (pieces.join(i, j)) --remaining;
    }
  }
  std::ranges::sort(edges);
  return edges;
}

Eigen::SparseMatrix<double> graph_laplacian(const SampleEdges& edges, Eigen::Index samples) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(4 * edges.size());
  for (const auto& [i, j] : edges) {
    entries.emplace_back(i, i, 1);
    entries.emplace_back(j, j, 1);
    entries.emplace_back(i, j, -1);
    entries.emplace_back(j, i, -1);
  }
  Eigen::SparseMatrix<double> laplacian(samples, samples);
  laplacian.setFromTriplets(entries.begin(), entries.end());
  return laplacian;
}

}  // namespace orbifit

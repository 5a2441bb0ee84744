#include "deformation/laplacian.h"

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>

#include "geometry/point_index.h"

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

struct Link {
  double distance;
  int a, b;  // pieces
};

// Pairs that make the pieces hang together: nearest pieces first (Kruskal 1956), at equal distances all at once.
void join_pieces(const Points& points, Pieces& pieces, SampleEdges& edges) {
  const int count = static_cast<int>(points.rows());
  std::vector<int> piece(static_cast<std::size_t>(count));
  std::map<int, int> number;
  for (int i = 0; i < count; ++i) {
    piece[static_cast<std::size_t>(i)] =
        number.try_emplace(pieces.find(i), static_cast<int>(number.size())).first->second;
  }
  const std::size_t size = number.size();
  if (size < 2) return;
  std::vector<double> least(size * size, std::numeric_limits<double>::infinity());
  const auto visit = [&](const auto& found) {
    for (int i = 0; i < count; ++i) {
      for (int j = i + 1; j < count; ++j) {
        const auto a = static_cast<std::size_t>(piece[static_cast<std::size_t>(i)]);
        const auto b = static_cast<std::size_t>(piece[static_cast<std::size_t>(j)]);
        if (a != b) found(i, j, least[std::min(a, b) * size + std::max(a, b)], (points.row(i) - points.row(j)).norm());
      }
    }
  };
  visit([](int, int, double& nearest, double distance) { nearest = std::min(nearest, distance); });
  std::vector<Link> links;
  for (std::size_t a = 0; a < size; ++a) {
    for (std::size_t b = a + 1; b < size; ++b) {
      links.push_back({least[a * size + b], static_cast<int>(a), static_cast<int>(b)});
    }
  }
  std::ranges::stable_sort(links, [](const Link& a, const Link& b) { return a.distance < b.distance; });
  Pieces joined(size);
  std::vector<char> chosen(size * size, 0);
  for (std::size_t first = 0; first < links.size();) {
    std::size_t end = first;
    while (end < links.size() && links[end].distance <= links[first].distance * (1 + kSameDistance)) ++end;
    for (std::size_t k = first; k < end; ++k) {
      if (joined.find(links[k].a) == joined.find(links[k].b)) continue;
      chosen[static_cast<std::size_t>(links[k].a) * size + static_cast<std::size_t>(links[k].b)] = 1;
    }
    for (std::size_t k = first; k < end; ++k) {
      if (chosen[static_cast<std::size_t>(links[k].a) * size + static_cast<std::size_t>(links[k].b)] != 0) {
        joined.join(links[k].a, links[k].b);
      }
    }
    first = end;
  }
  visit([&](int i, int j, const double& nearest, double distance) {
    const auto pair = static_cast<std::size_t>(&nearest - least.data());
    if (chosen[pair] != 0 && distance <= nearest * (1 + kSameDistance)) edges.emplace_back(i, j);
  });
}

}  // namespace

SampleEdges neighbour_graph(const Points& points, double distance) {
  return neighbour_graph(points, Eigen::VectorXd::Constant(points.rows(), 0.5 * distance));
}

SampleEdges neighbour_graph(const Points& points, const Eigen::VectorXd& radii) {
  const int count = static_cast<int>(points.rows());
  SampleEdges edges;
  if (count == 0) return edges;
  const PointIndex index(points);
  Pieces pieces(static_cast<std::size_t>(count));
  const double largest = radii.maxCoeff();
  for (int i = 0; i < count; ++i) {
    for (const auto& [j, length] : index.within(points.row(i).transpose(), radii[i] + largest)) {
      if (j <= i || length >= (radii[i] + radii[j]) * (1 - kSameDistance)) continue;
      edges.emplace_back(i, j);
      pieces.join(i, j);
    }
  }
  join_pieces(points, pieces, edges);
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

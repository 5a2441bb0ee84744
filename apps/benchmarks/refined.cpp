#include "refined.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <unordered_map>

namespace orbifit::benchmarks {

namespace {

class Splitter {
 public:
  Splitter(const Mesh& mesh, int n) : mesh_(mesh), n_(n) {
    const auto edges = static_cast<std::size_t>(3 * mesh.faces.rows() / 2);
    const auto n1 = static_cast<std::size_t>(n - 1);
    vertices_.reserve(static_cast<std::size_t>(mesh.vertices.rows()) + n1 * edges +
                      n1 * static_cast<std::size_t>(std::max(n - 2, 0)) / 2 *
                          static_cast<std::size_t>(mesh.faces.rows()));
    for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) vertices_.emplace_back(mesh.vertices.row(v));
    first_on_edge_.reserve(edges);
  }

  Mesh run() {
    const Eigen::Index pieces = Eigen::Index{n_} * n_;
    Mesh result;
    result.faces.resize(mesh_.faces.rows() * pieces, 3);
    for (Eigen::Index f = 0; f < mesh_.faces.rows(); ++f) split(f, result.faces, f * pieces);
    result.vertices.resize(static_cast<Eigen::Index>(vertices_.size()), 3);
    for (std::size_t v = 0; v < vertices_.size(); ++v) {
      result.vertices.row(static_cast<Eigen::Index>(v)) = vertices_[v];
    }
    return result;
  }

 private:
  // Point `step` of n from a to b; both faces of an edge get the same number.
  int on_edge(int a, int b, int step) {
    if (step == 0) return a;
    if (step == n_) return b;
    const bool swapped = a > b;
    const auto low = static_cast<std::uint64_t>(std::min(a, b));
    const auto high = static_cast<std::uint64_t>(std::max(a, b));
    const auto [entry, added] = first_on_edge_.try_emplace(low << 32U | high, static_cast<int>(vertices_.size()));
    if (added) {
      const Eigen::RowVector3d from = mesh_.vertices.row(static_cast<Eigen::Index>(low));
      const Eigen::RowVector3d to = mesh_.vertices.row(static_cast<Eigen::Index>(high));
      for (int i = 1; i < n_; ++i) vertices_.emplace_back((from * (n_ - i) + to * i) / n_);
    }
    return entry->second + (swapped ? n_ - step : step) - 1;
  }

  void split(Eigen::Index face, Triangles& faces, Eigen::Index at) {
    const std::array<int, 3> corner{mesh_.faces(face, 0), mesh_.faces(face, 1), mesh_.faces(face, 2)};
    // rows_[i][j]: the point i/n of the way to the first and j/n of the way to the second edge's end.
    rows_.resize(static_cast<std::size_t>(n_) + 1);
    for (int i = 0; i <= n_; ++i) {
      auto& row = rows_[static_cast<std::size_t>(i)];
      row.clear();
      for (int j = 0; i + j <= n_; ++j) row.push_back(point(corner, i, j));
    }
    const auto number = [&](int i, int j) { return rows_[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)]; };
    for (int i = 0; i < n_; ++i) {
      for (int j = 0; i + j < n_; ++j) {
        faces.row(at++) << number(i, j), number(i + 1, j), number(i, j + 1);
        if (i + j + 1 < n_) faces.row(at++) << number(i + 1, j), number(i + 1, j + 1), number(i, j + 1);
      }
    }
  }

  int point(const std::array<int, 3>& corner, int i, int j) {
    if (j == 0) return on_edge(corner[0], corner[1], i);
    if (i == 0) return on_edge(corner[0], corner[2], j);
    if (i + j == n_) return on_edge(corner[1], corner[2], j);
    const auto at = [&](int c) { return mesh_.vertices.row(corner[static_cast<std::size_t>(c)]); };
    vertices_.emplace_back((at(0) * (n_ - i - j) + at(1) * i + at(2) * j) / n_);
    return static_cast<int>(vertices_.size()) - 1;
  }

  const Mesh& mesh_;
  int n_;
  std::vector<Eigen::RowVector3d> vertices_;
  std::unordered_map<std::uint64_t, int> first_on_edge_;
  std::vector<std::vector<int>> rows_;
};

void refine_faces(std::vector<int>& faces, int pieces) {
  std::vector<int> result;
  result.reserve(faces.size() * static_cast<std::size_t>(pieces));
  for (const int face : faces) {
    for (int k = 0; k < pieces; ++k) result.push_back(face * pieces + k);
  }
  faces = std::move(result);
}

}  // namespace

GeneratedModel refined(const GeneratedModel& model, int n) {
  if (n <= 1) return model;
  GeneratedModel result{Splitter(model.mesh, n).run(), model.truth};
  result.truth.mesh_vertices = static_cast<int>(result.mesh.vertices.rows());
  result.truth.mesh_faces = static_cast<int>(result.mesh.faces.rows());
  for (Region& region : result.truth.regions) refine_faces(region.faces, n * n);
  for (Pattern& pattern : result.truth.patterns) {
    for (PatternInstance& instance : pattern.instances) refine_faces(instance.faces, n * n);
  }
  return result;
}

}  // namespace orbifit::benchmarks

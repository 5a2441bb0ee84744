#include "cases/bending.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>

namespace orbifit {

namespace {

using Eigen::Vector3d;

// An edge as one face has it: from its vertex `at` to the next.
struct HalfEdge {
  int low, high;  // its vertices
  int face, at;

  bool same_edge(const HalfEdge& other) const { return low == other.low && high == other.high; }
};

std::vector<HalfEdge> half_edges(const Mesh& mesh) {
  std::vector<HalfEdge> result;
  result.reserve(3 * static_cast<std::size_t>(mesh.faces.rows()));
  for (int face = 0; face < static_cast<int>(mesh.faces.rows()); ++face) {
    for (int at = 0; at < 3; ++at) {
      const auto [low, high] = std::minmax({mesh.faces(face, at), mesh.faces(face, (at + 1) % 3)});
      if (low != high) result.push_back({low, high, face, at});
    }
  }
  std::ranges::sort(result, {}, [](const HalfEdge& edge) { return std::array{edge.low, edge.high, edge.face}; });
  return result;
}

Vector3d area_normal(const Mesh& mesh, int face) {
  const Vector3d a = mesh.vertices.row(mesh.faces(face, 0));
  const Vector3d b = mesh.vertices.row(mesh.faces(face, 1));
  const Vector3d c = mesh.vertices.row(mesh.faces(face, 2));
  return 0.5 * (b - a).cross(c - a);
}

// Signed; zero where the faces are coplanar. Not a number where a face has no area.
double dihedral(const Mesh& mesh, const HalfEdge& first, const HalfEdge& second) {
  const Vector3d along = (mesh.vertices.row(first.high) - mesh.vertices.row(first.low)).transpose().normalized();
  const Vector3d a = area_normal(mesh, first.face);
  Vector3d b = area_normal(mesh, second.face);
  // Faces that agree about which side is out pass their edge in opposite directions.
  if (mesh.faces(first.face, first.at) == mesh.faces(second.face, second.at)) b = -b;
  if (a.norm() == 0 || b.norm() == 0) return std::nan("");
  return std::atan2(a.cross(b).dot(along), a.dot(b));
}

}  // namespace

Bending bending(const Mesh& rest, const Mesh& deformed) {
  constexpr double kWhole = 2 * std::numbers::pi;
  Bending result{0, Eigen::VectorXd::Zero(rest.vertices.rows())};
  const std::vector<HalfEdge> edges = half_edges(rest);
  double sum = 0;
  double area = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < edges.size(); i += count) {
    count = 1;
    while (i + count < edges.size() && edges[i + count].same_edge(edges[i])) ++count;
    if (count != 2) continue;
    const double change =
        std::remainder(dihedral(deformed, edges[i], edges[i + 1]) - dihedral(rest, edges[i], edges[i + 1]), kWhole);
    if (!std::isfinite(change)) continue;
    const double weight = area_normal(rest, edges[i].face).norm() + area_normal(rest, edges[i + 1].face).norm();
    sum += weight * change * change;
    area += weight;
    for (const int vertex : {edges[i].low, edges[i].high}) {
      result.of_vertex[vertex] = std::max(result.of_vertex[vertex], std::abs(change));
    }
  }
  if (area > 0) result.rms = std::sqrt(sum / area);
  return result;
}

}  // namespace orbifit

#include "surface/canonical_order.h"

#include <algorithm>
#include <array>
#include <utility>

#include "geometry/space_order.h"

namespace orbifit {

namespace {

using Place = std::array<double, 3>;
using Corners = std::array<Place, 3>;

Place place_of(const Mesh& mesh, int vertex) {
  return {mesh.vertices(vertex, 0), mesh.vertices(vertex, 1), mesh.vertices(vertex, 2)};
}

// The mesh with coordinates that are whole multiples of `grid`; as it is for none.
Mesh on_grid(Mesh mesh, double grid) {
  if (grid > 0) mesh.vertices = grid * (mesh.vertices / grid).array().round();
  return mesh;
}

// The corner of a face with which it begins.
int first_corner(const Mesh& mesh, int face) {
  int first = 0;
  for (int k = 1; k < 3; ++k) {
    if (place_of(mesh, mesh.faces(face, k)) < place_of(mesh, mesh.faces(face, first))) first = k;
  }
  return first;
}

std::array<int, 3> corners_of(const Mesh& mesh, int face) {
  const int first = first_corner(mesh, face);
  return {mesh.faces(face, first), mesh.faces(face, (first + 1) % 3), mesh.faces(face, (first + 2) % 3)};
}

Corners places_of(const Mesh& mesh, const std::array<int, 3>& corners) {
  return {place_of(mesh, corners[0]), place_of(mesh, corners[1]), place_of(mesh, corners[2])};
}

// By their corners, then along a curve that keeps neighbours together.
std::vector<int> ordered_faces(const Mesh& mesh) {
  const auto count = static_cast<std::size_t>(mesh.faces.rows());
  std::vector<std::pair<Corners, int>> by_corners;
  by_corners.reserve(count);
  for (int f = 0; f < static_cast<int>(count); ++f) by_corners.emplace_back(places_of(mesh, corners_of(mesh, f)), f);
  std::ranges::sort(by_corners);
  Points middles(mesh.faces.rows(), 3);
  for (std::size_t i = 0; i < count; ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    for (int c = 0; c < 3; ++c) {
      const auto axis = static_cast<std::size_t>(c);
      const Corners& corners = by_corners[i].first;
      middles(row, c) = corners[0][axis] / 3 + corners[1][axis] / 3 + corners[2][axis] / 3;
    }
  }
  std::vector<int> result;
  result.reserve(count);
  for (const int i : space_order(middles)) result.push_back(by_corners[static_cast<std::size_t>(i)].second);
  return result;
}

// As the faces come to them; then those of no face, by where they are.
std::vector<int> ordered_vertices(const Mesh& mesh, const std::vector<int>& faces) {
  std::vector<char> taken(static_cast<std::size_t>(mesh.vertices.rows()), 0);
  std::vector<int> result;
  result.reserve(taken.size());
  const auto take = [&](int vertex) {
    char& known = taken[static_cast<std::size_t>(vertex)];
    if (known == 0) result.push_back(vertex);
    known = 1;
  };
  for (const int f : faces) {
    for (const int vertex : corners_of(mesh, f)) take(vertex);
  }
  std::vector<std::pair<Place, int>> others;
  for (int v = 0; v < static_cast<int>(taken.size()); ++v) {
    if (taken[static_cast<std::size_t>(v)] == 0) others.emplace_back(place_of(mesh, v), v);
  }
  std::ranges::sort(others);
  for (const auto& other : others) take(other.second);
  return result;
}

}  // namespace

CanonicalOrder::CanonicalOrder(const Mesh& given, double grid) {
  const Mesh told = on_grid(given, grid);
  face_of = ordered_faces(told);
  const std::vector<int> vertices = ordered_vertices(told, face_of);
  std::vector<int> place(vertices.size());
  for (std::size_t i = 0; i < vertices.size(); ++i) place[static_cast<std::size_t>(vertices[i])] = static_cast<int>(i);
  mesh.vertices = given.vertices(vertices, Eigen::all);
  mesh.faces.resize(given.faces.rows(), 3);
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    const std::array<int, 3> corners = corners_of(told, face_of[static_cast<std::size_t>(f)]);
    for (int k = 0; k < 3; ++k) {
      mesh.faces(f, k) = place[static_cast<std::size_t>(corners[static_cast<std::size_t>(k)])];
    }
  }
}

}  // namespace orbifit

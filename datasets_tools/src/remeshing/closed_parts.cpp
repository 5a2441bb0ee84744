#include "remeshing/closed_parts.h"

#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <utility>

#include "orbifit/model/errors.h"

#include "geometry/topology.h"

namespace orbifit {

namespace {

constexpr double kSameSpot = 1e-9;  // of the diagonal

using Corners = std::array<int, 3>;

Corners corners_of(const Mesh& mesh, int face) {
  return {mesh.faces(face, 0), mesh.faces(face, 1), mesh.faces(face, 2)};
}

// The lowest corner first; the same turn.
Corners rotated(Corners corners) {
  std::rotate(corners.begin(), std::ranges::min_element(corners), corners.end());
  return corners;
}

Corners opposite(Corners corners) {
  std::swap(corners[1], corners[2]);
  return rotated(corners);
}

Mesh welded(const Mesh& mesh, const Weld& weld) {
  Mesh result;
  result.vertices = mesh.vertices(weld.representative, Eigen::all);
  result.faces = mesh.faces.unaryExpr([&](int v) { return weld.group_of_vertex[static_cast<std::size_t>(v)]; });
  return result;
}

// The first of each two opposite faces, if all faces go in such twos; else all faces.
std::vector<int> one_side(const Mesh& mesh, const std::vector<int>& faces) {
  std::map<Corners, int> fronts;
  std::vector<int> kept;
  for (const int face : faces) {
    const Corners corners = rotated(corners_of(mesh, face));
    const auto back = fronts.find(opposite(corners));
    if (back != fronts.end() && back->second > 0) {
      --back->second;
    } else {
      ++fronts[corners];
      kept.push_back(face);
    }
  }
  return 2 * kept.size() == faces.size() ? kept : faces;
}

struct Closure {
  bool closed = true;
  bool oriented = true;
};

Closure closure_of(const Mesh& mesh, const std::vector<int>& faces) {
  // Of each edge the faces at it, and how many more run upwards than downwards.
  std::map<std::pair<int, int>, std::pair<int, int>> edges;
  for (const int face : faces) {
    const Corners corners = corners_of(mesh, face);
    for (std::size_t k = 0; k < 3; ++k) {
      const int from = corners[k];
      const int to = corners[(k + 1) % 3];
      auto& [count, balance] = edges[std::minmax(from, to)];
      ++count;
      balance += from < to ? 1 : -1;
    }
  }
  Closure result;
  for (const auto& [edge, uses] : edges) {
    result.closed = result.closed && uses.first % 2 == 0;
    result.oriented = result.oriented && uses.second == 0;
  }
  return result;
}

}  // namespace

ClosedParts closed_parts(const Mesh& mesh) {
  const double size = diagonal(mesh.vertices);
  if (mesh.faces.rows() == 0) throw InputError("", "", "the mesh has no faces");
  if (!(size > 0)) throw InputError("", "", "the mesh has no size: all its vertices are at one place");
  ClosedParts result;
  result.mesh = welded(mesh, weld_vertices(mesh.vertices, kSameSpot * size));

  std::vector<int> with_extent;
  for (int f = 0; f < result.mesh.faces.rows(); ++f) {
    const Corners corners = corners_of(result.mesh, f);
    if (corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0]) with_extent.push_back(f);
  }
  Mesh solid{result.mesh.vertices, result.mesh.faces(with_extent, Eigen::all), {}};
  const Components components = connected_components(solid, weld_vertices(solid.vertices));

  for (const std::vector<int>& faces : components.faces) {
    const std::vector<int> side = one_side(solid, faces);
    const Closure closure = closure_of(solid, side);
    if (!closure.closed) {
      throw InputError("", "face " + std::to_string(with_extent[static_cast<std::size_t>(faces.front())]),
                       "belongs to a part of " + std::to_string(faces.size()) +
                           " faces that is not closed; only parts whose every edge has two faces have an inside");
    }
    for (const int face : side) {
      result.source_face.push_back(with_extent[static_cast<std::size_t>(face)]);
      result.part_of_face.push_back(static_cast<int>(result.parity_of_part.size()));
    }
    result.parity_of_part.push_back(!closure.oriented);
  }
  if (result.source_face.empty()) throw InputError("", "", "all faces of the mesh are without extent");
  result.mesh.faces = Triangles(result.mesh.faces(result.source_face, Eigen::all));
  return result;
}

}  // namespace orbifit

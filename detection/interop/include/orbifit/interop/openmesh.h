#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Core/Utils/PropertyManager.hh>

#include "orbifit/model/errors.h"
#include "orbifit/model/mesh.h"

namespace orbifit {

/// Faces that a half-edge mesh cannot hold together, and why.
struct OpenMeshObstacle {
  std::vector<int> faces;  ///< ascending
  std::string reason;      ///< "meet at the edge of vertices 4 and 9, ..."
};

namespace interop_detail {

// The property of faces in which Mesh::polygon_of_face goes along.
inline constexpr const char* kPolygonProperty = "orbifit:polygon_of_face";

template <typename TriMesh>
using ScalarOf = std::remove_cvref_t<decltype(std::declval<typename TriMesh::Point>()[0])>;

// An edge and the faces at it, ascending.
struct HalfEdgePair {
  std::array<int, 2> vertices;  // ascending
  std::vector<int> faces;
};

// Where faces run along an edge: from its lower vertex to its higher one, or back.
inline bool runs_upwards(const Mesh& mesh, int face, const HalfEdgePair& edge) {
  for (int k = 0; k < 3; ++k) {
    if (mesh.faces(face, k) == edge.vertices[0]) return mesh.faces(face, (k + 1) % 3) == edge.vertices[1];
  }
  return false;
}

inline bool has_repeated_vertex(const Mesh& mesh, int face) {
  const auto corners = mesh.faces.row(face);
  return corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0];
}

// All edges in ascending order of their vertices; connectivity is by vertex numbers, as in OpenMesh. Faces with a
// vertex twice have none.
inline std::vector<HalfEdgePair> edges_of(const Mesh& mesh) {
  std::vector<std::array<int, 3>> uses;  // lower vertex, higher vertex, face
  for (int f = 0; f < mesh.faces.rows(); ++f) {
    if (has_repeated_vertex(mesh, f)) continue;
    for (int k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax({mesh.faces(f, k), mesh.faces(f, (k + 1) % 3)});
      uses.push_back({low, high, f});
    }
  }
  std::ranges::sort(uses);
  std::vector<HalfEdgePair> edges;
  for (const auto& [low, high, face] : uses) {
    if (edges.empty() || edges.back().vertices != std::array{low, high}) edges.push_back({{low, high}, {}});
    edges.back().faces.push_back(face);
  }
  return edges;
}

// The fans of faces around the vertices, as sets of corners: corner k of face f has number 3 f + k.
class Fans {
 public:
  explicit Fans(const Mesh& mesh) : mesh_(mesh), first_(static_cast<std::size_t>(3 * mesh.faces.rows())) {
    std::iota(first_.begin(), first_.end(), 0);
    inner_edges_.resize(first_.size(), 0);
  }

  // The faces lie side by side at this edge.
  void join(const HalfEdgePair& edge) {
    for (const int vertex : edge.vertices) {
      const int a = fan(corner(edge.faces[0], vertex));
      const int b = fan(corner(edge.faces[1], vertex));
      first_[at(std::max(a, b))] = std::min(a, b);
      inner_edges_[at(std::min(a, b))] += 1 + (a == b ? 0 : inner_edges_[at(std::max(a, b))]);
    }
  }

  // By vertex: its fans, each as its faces, and whether one of them goes all the way round.
  void add_obstacles(std::vector<OpenMeshObstacle>& obstacles) {
    std::vector<int> sizes(first_.size(), 0);
    for (std::size_t c = 0; c < first_.size(); ++c) ++sizes[at(fan(static_cast<int>(c)))];
    struct Around {
      int fans = 0;
      bool closed = false;
    };
    std::vector<Around> around(static_cast<std::size_t>(mesh_.vertices.rows()));
    for (std::size_t c = 0; c < first_.size(); ++c) {
      if (fan(static_cast<int>(c)) != static_cast<int>(c)) continue;
      Around& here = around[at(mesh_.faces(static_cast<int>(c) / 3, static_cast<int>(c) % 3))];
      ++here.fans;
      here.closed = here.closed || inner_edges_[c] == sizes[c];
    }
    std::vector<std::vector<int>> faces(around.size());
    for (int f = 0; f < mesh_.faces.rows(); ++f) {
      for (const int vertex : mesh_.faces.row(f)) {
        if (around[at(vertex)].closed && around[at(vertex)].fans > 1) faces[at(vertex)].push_back(f);
      }
    }
    for (std::size_t v = 0; v < faces.size(); ++v) {
      if (faces[v].empty()) continue;
      obstacles.push_back({faces[v], "touch in vertex " + std::to_string(v) +
                                         " alone: no other face may be at a vertex that faces surround"});
    }
  }

 private:
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }

  int corner(int face, int vertex) const {
    int k = 0;
    while (mesh_.faces(face, k) != vertex) ++k;
    return 3 * face + k;
  }

  int fan(int corner) {
    while (first_[at(corner)] != corner) corner = first_[at(corner)] = first_[at(first_[at(corner)])];
    return corner;
  }

  const Mesh& mesh_;
  std::vector<int> first_;  // of the corners of a fan, found by following
  std::vector<int> inner_edges_;
};

// \throw InputError unless the list is empty
inline void refuse(const std::vector<OpenMeshObstacle>& obstacles) {
  constexpr std::size_t kMaxNamed = 10;  // a message that people read to its end
  if (obstacles.empty()) return;
  std::string text;
  for (std::size_t i = 0; i < std::min(obstacles.size(), kMaxNamed); ++i) {
    const auto& [faces, reason] = obstacles[i];
    text += (i == 0 ? "" : "; ") + std::string(faces.size() == 1 ? "face" : "faces");
    for (const int face : faces) text += (face == faces.front() ? " " : ", ") + std::to_string(face);
    text += " " + reason;
  }
  if (obstacles.size() > kMaxNamed) {
    text += "; and " + std::to_string(obstacles.size() - kMaxNamed) + " more, which openmesh_obstacles() names";
  }
  throw InputError("", "mesh", "OpenMesh cannot hold it: " + text);
}

}  // namespace interop_detail

/// What stands against holding the mesh as half-edges: faces with a vertex twice, edges of more than two faces or of
/// two that run along it in the same direction, and vertices that faces surround while others touch them. Connectivity
/// is by vertex numbers: vertices at the same place are apart. Costs O(F log F).
/// \return nothing if to_openmesh() can
/// do it
inline std::vector<OpenMeshObstacle> openmesh_obstacles(const Mesh& mesh) {
  std::vector<OpenMeshObstacle> obstacles;
  for (int f = 0; f < mesh.faces.rows(); ++f) {
    if (interop_detail::has_repeated_vertex(mesh, f)) obstacles.push_back({{f}, "has a vertex twice"});
  }
  interop_detail::Fans fans(mesh);
  for (const interop_detail::HalfEdgePair& edge : interop_detail::edges_of(mesh)) {
    const std::string where =
        " at the edge of vertices " + std::to_string(edge.vertices[0]) + " and " + std::to_string(edge.vertices[1]);
    if (edge.faces.size() > 2) {
      obstacles.push_back({edge.faces, "meet" + where + ", which has two faces at most"});
    } else if (edge.faces.size() == 2 && interop_detail::runs_upwards(mesh, edge.faces[0], edge) ==
                                             interop_detail::runs_upwards(mesh, edge.faces[1], edge)) {
      obstacles.push_back({edge.faces, "are oriented against each other" + where});
    } else if (edge.faces.size() == 2) {
      fans.join(edge);
    }
  }
  if (obstacles.empty()) fans.add_obstacles(obstacles);
  return obstacles;
}

/// The mesh as a TriMesh of OpenMesh; vertex and face i stay vertex and face i. Mesh::polygon_of_face goes along as a
/// property of the faces.
/// \tparam TriMesh  an OpenMesh::TriMesh_ArrayKernelT whose points are of double, such as OpenMesh::TriMesh
/// \throw InputError that names the faces of openmesh_obstacles() where there are any; nothing is ever left out
template <typename TriMesh>
TriMesh to_openmesh(const Mesh& mesh) {
  static_assert(std::is_same_v<interop_detail::ScalarOf<TriMesh>, double>,
                "orbifit needs a TriMesh whose traits have points of double, such as OpenMesh::DefaultTraitsDouble");
  interop_detail::refuse(openmesh_obstacles(mesh));
  TriMesh result;
  for (const auto& vertex : mesh.vertices.rowwise()) {
    result.add_vertex(typename TriMesh::Point(vertex[0], vertex[1], vertex[2]));
  }
  for (int f = 0; f < mesh.faces.rows(); ++f) {
    const auto corner = [&](int k) { return OpenMesh::VertexHandle(mesh.faces(f, k)); };
    if (!result.add_face(corner(0), corner(1), corner(2)).is_valid()) {
      interop_detail::refuse({{{f}, "was not accepted"}});
    }
  }
  if (!mesh.polygon_of_face.empty()) {
    auto polygons = OpenMesh::getOrMakeProperty<OpenMesh::FaceHandle, int>(result, interop_detail::kPolygonProperty);
    for (int f = 0; f < mesh.faces.rows(); ++f) {
      polygons[OpenMesh::FaceHandle(f)] = mesh.polygon_of_face[static_cast<std::size_t>(f)];
    }
  }
  return result;
}

/// The mesh that a TriMesh of OpenMesh holds. Vertices and faces keep their order; those marked as deleted, which wait
/// for garbage collection, are left out. Points of float are taken as they are.
/// \throw InputError for a vertex that is not finite
template <typename TriMesh>
Mesh from_openmesh(const TriMesh& mesh) {
  Mesh result;
  std::vector<int> number(mesh.n_vertices(), -1);
  result.vertices.resize(static_cast<Eigen::Index>(mesh.n_vertices()), 3);
  int vertices = 0;
  for (const auto vertex : mesh.vertices()) {
    const auto& point = mesh.point(vertex);
    result.vertices.row(vertices) << double(point[0]), double(point[1]), double(point[2]);
    if (!result.vertices.row(vertices).allFinite()) {
      throw InputError("", "vertex " + std::to_string(vertex.idx()), "is not finite");
    }
    number[static_cast<std::size_t>(vertex.idx())] = vertices++;
  }
  result.vertices.conservativeResize(vertices, 3);
  OpenMesh::FPropHandleT<int> polygons;
  const bool known = mesh.get_property_handle(polygons, interop_detail::kPolygonProperty);
  result.faces.resize(static_cast<Eigen::Index>(mesh.n_faces()), 3);
  int faces = 0;
  for (const auto face : mesh.faces()) {
    int k = 0;
    for (const auto vertex : mesh.fv_range(face)) {
      result.faces(faces, k++) = number[static_cast<std::size_t>(vertex.idx())];
    }
    if (known) result.polygon_of_face.push_back(mesh.property(polygons, face));
    ++faces;
  }
  result.faces.conservativeResize(faces, 3);
  // Faces that were added or split since have no polygon.
  if (!std::ranges::is_sorted(result.polygon_of_face)) result.polygon_of_face.clear();
  return result;
}

/// Moves the vertices of a TriMesh from which a mesh came by from_openmesh(), and was edited: all else that the TriMesh
/// has (texture coordinates, colours, properties) stays.
/// \param vertices  #V by 3, as many as the TriMesh has that are not deleted  \throw UsageError otherwise
template <typename TriMesh>
void move_vertices(TriMesh& mesh, const Points& vertices) {
  Eigen::Index row = 0;
  for (const auto vertex : mesh.vertices()) {
    (void)vertex;
    ++row;
  }
  require(row == vertices.rows(), "number of vertices", static_cast<double>(vertices.rows()), std::to_string(row));
  row = 0;
  for (const auto vertex : mesh.vertices()) {
    const auto& from = vertices.row(row++);
    for (int k = 0; k < 3; ++k) {
      mesh.point(vertex)[static_cast<std::size_t>(k)] = static_cast<interop_detail::ScalarOf<TriMesh>>(from[k]);
    }
  }
}

}  // namespace orbifit

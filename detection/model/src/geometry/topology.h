#pragma once

#include <array>
#include <vector>

#include "orbifit/model/mesh.h"

namespace orbifit {

/// Vertices at one place share a number.
struct Weld {
  std::vector<int> group_of_vertex;  ///< #V, numbered by first appearance
  std::vector<int> representative;   ///< one vertex of each group, the first
};

/// Groups vertices that lie within `tolerance` (mesh units; 0: the very same coordinates) of a group's first vertex.
Weld weld_vertices(const Points& vertices, double tolerance = 0);

/// Faces connected over shared edges of the welded mesh.
struct Components {
  std::vector<int> component_of_face;   ///< #F, numbered by first appearance
  std::vector<std::vector<int>> faces;  ///< of each component, ascending
};

Components connected_components(const Mesh& mesh, const Weld& weld);

/// What becomes of sets of faces most of which repeat those of another set, as the two sides of a sheet do.
enum class DoubledParts { united, apart };

/// The same, but solids that touch along an edge stay apart: where more than two faces meet at an edge of the welded
/// mesh and the mesh's own vertices pair them, they are connected within these pairs only.
Components touching_parts(const Mesh& mesh, const Weld& weld, DoubledParts doubled = DoubledParts::united);

/// An edge of the welded mesh with the faces at it; `faces` is empty for none, 1 at a boundary, > 2 non-manifold.
struct Edge {
  std::array<int, 2> vertices;  ///< groups of the weld, ascending
  std::vector<int> faces;
};

/// All edges in ascending order of their vertices; faces degenerate after welding contribute none.
std::vector<Edge> welded_edges(const Mesh& mesh, const Weld& weld);

/// What `orbifit info` reports: counts of what a mesh should not have.
struct MeshReport {
  int vertices = 0, faces = 0, components = 0;
  int duplicate_vertices = 0;  ///< at the very same coordinates as an earlier one
  int unused_vertices = 0;
  int degenerate_faces = 0;     ///< of no area
  int duplicate_faces = 0;      ///< the same welded corners as an earlier one, in any order
  int boundary_edges = 0;       ///< of the welded mesh
  int non_manifold_edges = 0;   ///< more than two faces
  int inconsistent_edges = 0;   ///< two faces that run along it in the same direction
  bool watertight = false;      ///< no boundary and no non-manifold edges
  double area = 0, volume = 0;  ///< volume 0 unless watertight
  double diagonal = 0;
  Eigen::Vector3d minimum = Eigen::Vector3d::Zero(), maximum = Eigen::Vector3d::Zero();
};

MeshReport inspect(const Mesh& mesh);

}  // namespace orbifit

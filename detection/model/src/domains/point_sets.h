#pragma once

#include <vector>

#include "orbifit/model/mesh.h"

namespace orbifit {

class DomainMap;

/// Of a mesh's vertices, which are one point of one part, and in which places that is: those of all faces around it.
/// Vertices at one position are one point where their faces have an edge in common, as in soups; parts that merely
/// touch have points of their own.
struct PointSets {
  std::vector<int> weld;   ///< #V: the smallest vertex at the same position
  std::vector<int> roots;  ///< #V: the vertex that stands for the point
  std::vector<int> sets;   ///< #V: number of the set of places of each root
};

inline constexpr double kSamePosition = 1e-9;  ///< of the diagonal: what writing a mesh to a file rounds away

/// Of each vertex, the smallest index of a vertex at the same position.
std::vector<int> welded_vertices(const Points& vertices);

/// As DomainMap::points() has it; where there are no places every vertex is a point.
PointSets point_sets(const Mesh& mesh, const DomainMap& domains);

/// The set of each vertex' point.
std::vector<int> by_vertex(const PointSets& points);

}  // namespace orbifit

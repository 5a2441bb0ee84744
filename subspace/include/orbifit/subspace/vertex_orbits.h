#pragma once

#include <vector>

#include "orbifit/model/mesh.h"
#include "orbifit/subspace/region_map.h"

namespace orbifit {

/// The vertices of a mesh grouped into orbits of the region that holds the whole mesh, where such a region exists and
/// its elements map vertices onto vertices. A mesh read from a file of few digits has images that miss their vertices
/// by the digits' rounding; taking the displacement of one vertex an orbit makes the deformed mesh as symmetric as the
/// file was, to rounding in double precision.
struct VertexOrbits {
  int region = -1;           ///< the whole-mesh region with the largest group; -1: none, and nothing below
  std::vector<int> source;   ///< #V: the vertex whose displacement this one follows; itself for a source
  std::vector<int> element;  ///< #V: number of the element of the region's group that maps source to here
  struct Stabiliser {
    int vertex;                 ///< a source
    std::vector<int> elements;  ///< that map it to itself, the identity among them
  };
  std::vector<Stabiliser> stabilisers;  ///< of the sources that have more than the identity
};

/// Vertices within `tolerance` (mesh units) of an image of a source, coincident ones included, follow it.
/// O(V log V).
VertexOrbits vertex_orbits(const Mesh& mesh, const RegionMap& regions, double tolerance);

/// Makes displacements exactly symmetric on the orbits: that of a source is averaged over its stabiliser, the others
/// are u = O u_source + (I - O) t.
/// \param displacements #V by 3
/// \param translation   t of the region (floating); zero when groups are fixed
void symmetrise(const VertexOrbits& orbits, const RegionMap& regions, const Eigen::Vector3d& translation,
                Points& displacements);

}  // namespace orbifit

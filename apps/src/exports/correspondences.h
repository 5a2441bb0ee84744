#pragma once

#include <string>
#include <vector>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

namespace orbifit {

/// Which vertex a region's elements take each of its vertices to.
struct Correspondences {
  std::vector<int> vertices;                   ///< of the region, ascending
  std::vector<int> elements;                   ///< numbers in the region's list
  std::vector<std::vector<int>> images;        ///< by element, by vertex: the image's vertex, -1 where none is near
  std::vector<std::vector<double>> distances;  ///< by element, by vertex: to the nearest vertex, mesh units
  std::vector<int> orbits;                     ///< by vertex: a label from 0; what `images` relate has the same
  int unmatched = 0;                           ///< pairs of vertex and element without an image
};

/// \param elements  numbers in the region's list; empty: all
/// \param reach     mesh units: how far a vertex may be from the place to which an element takes another
/// \pre a finite group
Correspondences correspondences(const Mesh& mesh, const Region& region, const std::vector<int>& elements, double reach,
                                const RunContext& context);

/// `element,vertex,image,distance`, a line each.
std::string to_csv(const Correspondences& correspondences);
/// `vertex,orbit`, a line each.
std::string orbits_csv(const Correspondences& correspondences);
/// `vertices` (V), `orbits` (V), `elements` (E), `motions` (E, 3, 4), `images` (E, V), `distances` (E, V).
std::string to_npz(const Correspondences& correspondences, const Region& region);

}  // namespace orbifit

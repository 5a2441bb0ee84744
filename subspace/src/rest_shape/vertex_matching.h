#pragma once

#include <vector>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"
#include "orbifit/model/run_context.h"

namespace orbifit {

/// The places at which a mesh has vertices: vertices at one place (to 1e-7 of the diagonal) move together.
struct Places {
  std::vector<int> of_vertex;                ///< #V
  Points positions;                          ///< #P by 3
  std::vector<std::vector<int>> neighbours;  ///< #P, over edges, ascending
};

Places vertex_places(const Mesh& mesh);

/// The places of a region's vertices, ascending.
std::vector<int> places_of(const Places& places, const Mesh& mesh, const Region& region);

/// For each of the region's places the number, among them, of the one onto which `motion` maps it, or -1. Pairs are
/// one to one, nearest to one another, within `reach`, and either much closer than the place's nearest neighbour is or
/// borne out by their own neighbours: what maps by chance, between unrelated tessellations, does neither. Where noise
/// is as large as the triangles, pairs are those of places that are smoothed: what edges join alike stays alike.
/// \param inside places_of() the region
/// \param reach  mesh units
std::vector<int> matched_places(const Places& places, const std::vector<int>& inside, const Motion& motion,
                                double reach, const RunContext& context);

}  // namespace orbifit

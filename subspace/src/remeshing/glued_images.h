#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "remeshing/clipped_surface.h"
#include "remeshing/finite_group.h"
#include "remeshing/seams.h"

namespace orbifit {

/// The images of a domain's surface under a whole group, welded along its walls.
struct GluedImages {
  std::vector<Eigen::Vector3d> points;
  std::vector<std::array<int, 3>> triangles;
  std::vector<int> sources;   ///< of each triangle, as in the domain
  std::vector<int> elements;  ///< of each triangle: which image of the domain it is in
  int contradictions = 0;     ///< places of which pairings ask what cannot be
};

/// Welds by the pairings alone, whatever the coordinates: vertices that they relate are one orbit, its first takes the
/// mean of all, taken back to it and to where its stabiliser leaves it, and all others are its images.
/// \param reach  mesh units: how far from each other what becomes one may be
GluedImages glued_images(const ClippedSurface& surface, const FiniteGroup& group, const Seams& seams, double reach);

}  // namespace orbifit

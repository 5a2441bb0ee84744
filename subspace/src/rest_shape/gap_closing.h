#pragma once

#include <vector>

#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

#include "rest_shape/image_pairs.h"
#include "rest_shape/matched_orbits.h"

namespace orbifit {

/// Puts the members of an orbit where its motions take `first`.
void place_images(const PlaceOrbit& orbit, const Eigen::Vector3d& first, Points& positions);

struct GapWeights {
  std::vector<char> free;         ///< by orbit: whether it may move
  std::vector<double> of_region;  ///< what a squared distance weighs, 1 / mesh units squared
  std::vector<char> stiff;        ///< by place: edges between such stay stiff to the end
};

/// Closes, as far as it goes, the gaps between images that lie between vertices and the surface: minimises
///
///     sum over pairs of  w_region |M p - q|^2  +  stiffness * mean over edges of  |d_a - d_b|^2 / length^2,
///
/// q = sum of b_i x_i the point of the surface nearest to M p, d the displacements since `rest`, over the positions of
/// orbits' first members, where stabilisers let them go; the other members are their images, so that what is exactly
/// symmetric stays so. The surface's points move with the surface. For fixed nearest points that is linear least
/// squares, by conjugate gradients, which lower the sum with every step, and so do new nearest points: as in ICP (Besl
/// and McKay 1992) the sum never grows. Stiff at first, so that what is misplaced by more than it is fine finds its
/// like before it bends. \param reach     images farther than this from the surface have no part
/// in it, mesh units \param places    at rest \param positions of the places, #P by 3, in and out \return iterations
int close_gaps(ImagePairs& pairs, const std::vector<PlaceOrbit>& orbits, const GapWeights& weights, double reach,
               const Places& places, Points& positions, const RunContext& context);

}  // namespace orbifit

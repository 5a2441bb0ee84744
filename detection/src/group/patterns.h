#pragma once

#include <optional>
#include <vector>

#include "orbifit/model/annotation.h"

#include "group/refinement.h"
#include "surface/components.h"

namespace orbifit {

/// A way to see the copies of a part as a regular arrangement.
struct Arrangement {
  Pattern::Kind kind = Pattern::Kind::congruent;
  std::vector<Motion> generators;
  std::vector<Motion> motions;  ///< of each copy from the first, on the arrangement exactly
  double filled = 0;            ///< of the places that a lattice's copies span, the share that holds one
};

/// Names the arrangement of copies placed by `motions` (the first is the identity): a lattice of translations of one to
/// three generators, an arc of rotations, a screw, or none (`congruent`).
/// \param own group of the copy at the first place, by which a motion may be changed; null when it has none
/// \param centroid of the first copy \param reach its radius \param tolerance how far a copy may be off its place
Arrangement arrange(const std::vector<Motion>& motions, const GroupPlacement* own, const Eigen::Vector3d& centroid,
                    double reach, double tolerance);

/// How a motion brings a patch's samples onto some faces: distances in the frame of the prepared mesh.
struct CopyFit {
  double kept = 0;  ///< share of the samples within the patch's tolerance
  double square = 0, largest = 0;
};
CopyFit fit_of_copy(const SurfacePatch& patch, const Motion& motion, const std::vector<int>& faces);
inline constexpr double kKeptOfCopy = 0.9;  ///< the least that an instance keeps

/// The motion that takes a copy to the same place as `motion` and turns least: motion g for g in the copy's own group.
Motion straightened(const Motion& motion, const GroupPlacement& own);

}  // namespace orbifit

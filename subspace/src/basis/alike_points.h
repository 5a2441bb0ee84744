#pragma once

#include <vector>

#include <Eigen/Core>

#include "basis/vertex_orbits.h"
#include "sampling/symmetric_sampling.h"
#include "symmetry/group_words.h"
#include "symmetry/region_map.h"

namespace orbifit {

/// Points of an orbit that a symmetry of everything, samples and places alike, takes to one another: pulled back to
/// where the orbit begins their lifts are one. \param carriers  translations that carry the groups under any
/// displacement of the basis, 3 each; none where the groups are fixed
/// \return for each point of vertices.point_words for how many of its orbit, itself among them, it stands; 0: another
/// one stands for it
std::vector<int> points_stood_for(const SymmetricSampling& sampling, const RegionMap& regions, const GroupWords& words,
                                  const Eigen::VectorXd& carriers, const VertexOrbits& vertices);

}  // namespace orbifit

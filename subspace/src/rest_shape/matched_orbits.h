#pragma once

#include <vector>

#include "rest_shape/vertex_matching.h"

namespace orbifit {

/// What one region asks of the places: its generators as maps between them.
struct RegionMatching {
  std::vector<int> inside;                ///< places of the region, ascending
  std::vector<Motion> generators;         ///< of its group
  std::vector<std::vector<int>> matches;  ///< of each generator: matched_places()
};

/// Places that are images of one another, place by place.
struct PlaceOrbit {
  std::vector<int> members;         ///< the first is the one to compute
  std::vector<Motion> motions;      ///< from the first to each member
  std::vector<Motion> stabilisers;  ///< motions that must leave the first in place
  bool complete = true;             ///< every image under every region is a member
  bool clashes = false;             ///< regions were left out since two ways lead to one place, but not to one point
};

/// Orbits of all places; each lies in one. Where a region has places in an orbit whose images are none, the region is
/// left out of that orbit, which then is not complete. Where groups disagree, so that a place has no position, by more
/// than rounding, that all ways there lead to, and where members would fall together or go too far, the annotation's
/// last region in the orbit is. So what an orbit's motions make of any position of its first member that the
/// stabilisers leave in place is exactly symmetric under all regions that are not left out.
/// \param scale the mesh's diagonal
/// \param reach how far a place may be from where its orbit would have it, mesh units
std::vector<PlaceOrbit> matched_orbits(const Places& places, const std::vector<RegionMatching>& regions, double scale,
                                       double reach);

/// The mean over an orbit of its members, each taken back to the first, moved to where the stabilisers leave it.
Eigen::Vector3d orbit_mean(const PlaceOrbit& orbit, const Points& positions);

/// The projection, 3 by 3, onto the directions in which the first member may go.
Eigen::Matrix3d free_directions(const PlaceOrbit& orbit);

/// The point nearest to `point` that the orbit's stabilisers leave in place.
Eigen::Vector3d stabilised(const PlaceOrbit& orbit, const Eigen::Vector3d& point);

}  // namespace orbifit

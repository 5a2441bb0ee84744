#pragma once

#include <vector>

#include <Eigen/Core>

#include "remeshing/finite_group.h"

namespace orbifit {

/// A plane through the group's centre that bounds a fundamental domain, which lies where normal . (x - centre) <= 0.
/// Across it lies the domain's image under `element`.
struct Wall {
  int element = 0;
  int partner = 0;         ///< the wall that `element` takes onto this one; itself for elements of order two
  bool mirror = false;     ///< `element` fixes the wall point by point
  Eigen::Vector3d normal;  ///< unit
  /// Where the partner is the wall itself, and it is no mirror: a unit vector in the wall. The element exchanges the
  /// two halves in which (x - centre) . half is positive or negative.
  Eigen::Vector3d half = Eigen::Vector3d::Zero();
};

struct FundamentalDomain {
  Eigen::Vector3d centre;
  std::vector<Wall> walls;  ///< at most 30; none of them is implied by the others
};

/// The Dirichlet domain of a point: what is at least as near to it as to any of its images. For groups that mirrors
/// generate it is a chamber between mirrors, for Cn a wedge.
/// \param direction  from the centre to the point, which no element but the identity fixes
FundamentalDomain dirichlet_domain(const FiniteGroup& group, const Eigen::Vector3d& direction);

/// Directions to try, none of which an element fixes, and no two of one domain; a function of the group alone.
std::vector<FundamentalDomain> candidate_domains(const FiniteGroup& group);

}  // namespace orbifit

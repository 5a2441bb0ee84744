#pragma once

#include <vector>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"

#include "symmetry/region_map.h"

namespace orbifit {

/// The instances of a pattern as powers of its generators, and how they may move (docs/method.md 2.2; Bokeloh et al.
/// 2012): u_j(m_j p) = O u_0(p) + tau_j. On a lattice of translations tau_j = sum of k tau, along an arc or a screw
/// tau_k = sum over m < k of O^m tau, so that the step stays regular while it changes; free for mere copies.
struct Lattice {
  bool regular = false;         ///< every instance is a product of powers of the generators
  std::vector<Motion> motions;  ///< of the instances, exact products; #instances
  std::vector<Carried> shifts;  ///< tau_j by variable 0 ... variables - 1; #instances
  int variables = 0;
};

Lattice lattice_of(const Mesh& mesh, const Pattern& pattern);

}  // namespace orbifit

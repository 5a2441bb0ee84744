#pragma once

#include <vector>

#include "orbifit/subspace/deformer.h"

#include "basis/conjugated_regions.h"
#include "basis/lift.h"
#include "deformation/contact_energy.h"
#include "deformation/corotation.h"
#include "deformation/handle_rows.h"

namespace orbifit {

/// Co-rotated Laplace editing while the regions' groups turn (docs/method.md 2.2, moving). An iteration solves for the
/// coordinates and, to first order, for the families' rotations together; then the rotations are applied exactly and
/// the basis is built anew, so that every state keeps every carried symmetry to rounding.
class MovingSolve {
 public:
  /// \param contact_weight  see ContactEnergy
  MovingSolve(const Subspace& subspace, const Corotation& corotation, std::vector<Contact> contacts,
              double contact_weight, const RunContext& context);

  Deformation solve(const HandleRows& handles, double alpha, const std::vector<Motion>& motions, int iterations,
                    const SubspaceState& start, const RunContext& context) const;

 private:
  struct Stand;
  struct Solved;
  class Run;

  ConjugatedRegions::Turns first_turns(const HandleRows& handles, const Eigen::VectorXd& targets) const;

  const Subspace& subspace_;
  const Corotation& corotation_;
  ConjugatedRegions regions_;
  std::vector<Contact> contacts_;
  double contact_weight_;
};

}  // namespace orbifit

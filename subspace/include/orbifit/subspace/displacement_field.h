#pragma once

#include <vector>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"
#include "orbifit/subspace/subspace.h"

namespace orbifit {

/// The displacement field at any points in space, #P by 3: the orbit average is taken anew at each point, without the
/// baked lift. Symmetric in every place, and continuous, also where one place ends inside another or at one that it
/// does not overlap, but for the thousandth of a Gaussian at which it is cut, and for borders that a group takes to
/// where no place ends: there continuity would ask for the border's symmetry around its images, which lie in no such
/// place, so the field jumps at the border or at its images (docs/architecture.md).
/// \param sets the places that each point counts to, #P (see RegionMap)
Points displacement_field(const Subspace& subspace, const SubspaceState& state, const Points& points,
                          const std::vector<int>& sets, const RunContext& context);

/// How well the displacement is symmetric: |y(g p) - g' y(p)| over vertices p of a region and elements g, g' being g
/// carried along, as a fraction of the diagonal. Where g p is a vertex its displacement as baked is taken; elsewhere
/// both come from the field, in space at g p, which has no floor from the tessellation. Of a large region every k-th
/// vertex is taken, so that about `pairs` pairs (p, g) are, and of those where g p is no vertex a twentieth.
Residual field_residual(const Subspace& subspace, const Mesh& mesh, const Region& region, int region_number,
                        const SubspaceState& state, const RunContext& context, int pairs = 20000);
Residual field_residual(const Subspace& subspace, const Mesh& mesh, const Region& region, int region_number,
                        const Eigen::VectorXd& q, const RunContext& context);

/// The same of all regions of an annotation, in its order; what they share is made once.
std::vector<Residual> field_residuals(const Subspace& subspace, const Mesh& mesh, const SymmetryAnnotation& annotation,
                                      const SubspaceState& state, const RunContext& context, int pairs = 20000);

/// The largest `max` of field_residuals(), 0 without regions.
double worst_field_residual(const Subspace& subspace, const Mesh& mesh, const SymmetryAnnotation& annotation,
                            const SubspaceState& state, const RunContext& context);

/// As field_residual() of a pattern's instances: each against instance 0.
Residual pattern_residual(const Subspace& subspace, const Mesh& mesh, const Pattern& pattern, int pattern_number,
                          const SubspaceState& state, const RunContext& context);

}  // namespace orbifit

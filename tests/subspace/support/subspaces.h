#pragma once

#include <string>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/model/mesh.h"
#include "orbifit/subspace/handles.h"
#include "orbifit/subspace/subspace.h"

namespace orbifit {

/// A subspace of a model with a radius given as a fraction of its diagonal.
Subspace subspace_of(const GeneratedModel& model, GroupMode mode, double relative_radius,
                     LiftKind lift = LiftKind::orbit);

/// Random coordinates of standard deviation `size` times the diagonal; in mode moving every group is turned as well, by
/// about `turn` radians in each of the ways in which it may.
SubspaceState random_state(const Subspace& subspace, double size, double turn = 0.3);

/// The model with a random point set into every third face or so, which is no image of any other such point: most
/// vertices lose their images. Regions and patterns keep their surfaces.
GeneratedModel cut_irregularly(const GeneratedModel& model);

/// The largest field_residual of all regions and pattern_residual of all patterns, and whose it is.
struct WorstResidual {
  double residual = 0;
  std::string name;
};
WorstResidual worst_residual(const GeneratedModel& model, const Subspace& subspace, const SubspaceState& state,
                             int pairs = 2000);

/// The vertices within `radius` of `centre`.
Handle handle_at(const Mesh& mesh, const Eigen::Vector3d& centre, double radius);

}  // namespace orbifit

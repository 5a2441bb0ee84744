#pragma once

#include <vector>

#include "orbifit/detection/components.h"
#include "orbifit/detection/refinement.h"
#include "orbifit/detection/surface_patch.h"
#include "orbifit/model/run_context.h"

namespace orbifit {

/// The components that a group permutes: the orbit test of S(G) (method of maximal regions) on whole components. A
/// component stays when every element carries it onto a component of like size that stays too.
/// \param seed components that are known to belong
/// \return component numbers, ascending
std::vector<int> permuted_components(const PreparedMesh& prepared, const ComponentSurvey& survey,
                                     const SurfaceIndex& whole, const GroupPlacement& placement,
                                     const std::vector<int>& seed, double tolerance, const RunContext& context);

/// Whether every element of `inner` is one of `outer` on points within `reach` of `centre`, to `tolerance` (a length).
bool contains_group(const GroupPlacement& outer, const GroupPlacement& inner, const Eigen::Vector3d& centre,
                    double reach, double tolerance);

}  // namespace orbifit

#pragma once

#include <Eigen/Core>

#include "orbifit/model/run_context.h"
#include "orbifit/subspace/subspace.h"

namespace orbifit {

/// A state in the coordinates of another subspace of the same mesh and annotation, whose groups are at rest, DoF of
/// `to`: the same displacement of its samples and of the groups, wherever that subspace contains it, else the nearest
/// (docs/method.md 7.1). \throw NoResultError where these coordinates cannot be solved for
Eigen::VectorXd transferred(const Subspace& from, const SubspaceState& state, const Subspace& to,
                            const RunContext& context);

}  // namespace orbifit

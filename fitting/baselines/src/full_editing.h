#pragma once

#include <vector>

#include <Eigen/Core>

#include "orbifit/baselines/full_sampling.h"
#include "orbifit/fitting/fit.h"
#include "orbifit/subspace/handles.h"
#include "orbifit/subspace/subspace.h"

namespace orbifit {

/// Co-rotated Laplace editing (paper, section 6) on the full sampling, with the energy, handles and iterations of
/// Deformer. Factorised once.
/// \param subspace of the paper's lift \param[out] record  one entry an iteration, and the condition where asked
/// \return the unknowns (u, t): see FullSystem
Eigen::VectorXd edit_full_sampling(const Subspace& subspace, const Mesh& mesh, const std::vector<Handle>& handles,
                                   const FullSamplingOptions& options, FitResult& record);

}  // namespace orbifit

#pragma once

#include <string>

#include "orbifit/fitting/fit.h"
#include "orbifit/model/run_context.h"

namespace orbifit {

/// How displacements of all samples are asked to keep the symmetries.
enum class FullSymmetry {
  none,        ///< not at all: co-rotated non-rigid ICP
  soft,        ///< by a penalty
  constrained  ///< by linear constraints with Lagrange multipliers
};

std::string to_string(FullSymmetry symmetry);

struct FullSamplingOptions {
  FitOptions fit;  ///< its subspace says how to sample and what becomes of the groups; the lift is the paper's
  FullSymmetry symmetry = FullSymmetry::constrained;
  double weight = 1;         ///< of the mean of |u(g x) - O u(x) - (I - O) t|^2 against that of the data, soft, > 0
  double alpha = 100;        ///< weight of handles where there is no scan (paper, equation 3), > 0
  int edit_iterations = 10;  ///< then, >= 1

  void validate() const;  ///< \throw UsageError naming the field, its value and the rule
};

/// The paper's co-rotated Laplace energy (section 6) on the full sampling: the unknowns are the displacements of all
/// samples and the translations that carry groups. The iterations, correspondences, weights and stopping rules are
/// those of fit(), from one start; only the space and what keeps the symmetries differ. A scan without points and with
/// handles asks for an edit by those handles as Deformer does it; the pose then stays.
/// Of the result, `q` holds the unknowns, `field_residual` is the largest residual of a constraint at the samples, of
/// the diagonal, and `annotation` has the groups as carried by the unknown translations. Times: "prepare" and "fit".
/// \throw InputError for a scan of 1 to 9 points, or none and no handles; NoResultError where the system is not
///        positive definite to rounding, as weights grow
FitResult fit_full_sampling(const FitInput& input, const FullSamplingOptions& options, const RunContext& context);

}  // namespace orbifit

#pragma once

#include "orbifit/fitting/fit.h"
#include "orbifit/model/run_context.h"

namespace orbifit {

struct SimilarityOptions {
  FitOptions fit;       ///< of these what concerns the scan and the pose
  int iterations = 30;  ///< of the ICP with scale that follows the rigid one, >= 1

  void validate() const;  ///< \throw UsageError
};

/// Rigid ICP, then ICP with scale: the template is moved, not deformed. Without a scan, the similarity that takes the
/// handles' vertices nearest to their targets (Umeyama 1991). Times: "prepare" and "fit".
/// \throw InputError for a scan of 1 to 9 points, or none and no handles
FitResult fit_similarity(const FitInput& input, const SimilarityOptions& options, const RunContext& context);

}  // namespace orbifit

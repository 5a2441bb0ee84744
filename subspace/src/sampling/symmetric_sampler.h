#pragma once

#include "sampling/border_points.h"
#include "sampling/symmetric_sampling.h"

namespace orbifit {

/// Samples one mesh with one radius after another, as sample_symmetrically() does: borders are looked for once.
class SymmetricSampler {
 public:
  /// References are kept.
  SymmetricSampler(const Mesh& mesh, const RegionMap& regions)
      : mesh_(mesh), regions_(regions), borders_(mesh, regions) {}

  SymmetricSampling sample(GroupWords& words, const SamplingOptions& options, const RunContext& context) const;

 private:
  const Mesh& mesh_;
  const RegionMap& regions_;
  AbuttingPlaces borders_;
};

}  // namespace orbifit

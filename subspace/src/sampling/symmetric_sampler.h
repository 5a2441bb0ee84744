#pragma once

#include "sampling/border_points.h"
#include "sampling/symmetric_sampling.h"

namespace orbifit {

/// Samples one mesh with one radius after another, as sample_symmetrically() does.
class SymmetricSampler {
 public:
  /// References are kept.
  SymmetricSampler(const Mesh& mesh, const RegionMap& regions, const AbuttingPlaces& borders)
      : mesh_(mesh), regions_(regions), borders_(borders) {}

  SymmetricSampling sample(GroupWords& words, const SamplingOptions& options, const RunContext& context) const;

 private:
  const Mesh& mesh_;
  const RegionMap& regions_;
  const AbuttingPlaces& borders_;
};

}  // namespace orbifit

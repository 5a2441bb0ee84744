#pragma once

#include <vector>

#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"
#include "orbifit/subspace/orbit.h"
#include "orbifit/subspace/region_map.h"

namespace orbifit {

/// A sampling of the surface whose symmetries are those of the regions (paper, section 5, "Symmetric sampling").
/// Samples are listed orbit by orbit, each orbit's seed first.
struct SymmetricSampling {
  double radius = 0;                  ///< r, mesh units: every surface point has a sample within r
  Points points;                      ///< #S by 3; near the surface, on it where nothing snapped them
  std::vector<int> orbit_of_sample;   ///< #S
  std::vector<int> first_sample;      ///< of each orbit, and #S at the end
  std::vector<Transport> transports;  ///< #S, from the orbit's seed
  struct Constraint {
    int orbit;
    Transport left, right;  ///< of one place: they must give the same displacement
  };
  std::vector<Constraint> constraints;

  int orbits() const { return static_cast<int>(first_sample.size()) - 1; }
};

struct SamplingOptions {
  double radius = 0;     ///< r, mesh units, > 0
  bool floating = true;  ///< see ClosureOptions
  int most_samples = 20000;
};

/// Symmetric Poisson-disc sampling: seeds are drawn at random from a dense uniform sampling of the surface, each brings
/// its whole orbit, and what lies within r of a sample is not drawn again. A seed that its own images crowd (closer
/// than 0.4 r) moves onto the fixed set of the motions that do so, where they coincide.
/// Costs O(candidates + sum over orbits of their size), candidates about 30 a disc.
/// \throw InputError when the mesh has no area, an orbit does not close, or more than most_samples are needed
SymmetricSampling sample_symmetrically(const Mesh& mesh, const RegionMap& regions, const SamplingOptions& options,
                                       const RunContext& context);

}  // namespace orbifit

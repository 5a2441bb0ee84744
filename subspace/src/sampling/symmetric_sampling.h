#pragma once

#include <vector>

#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

#include "geometry/sampling.h"
#include "symmetry/group_words.h"
#include "symmetry/orbit.h"
#include "symmetry/region_map.h"

namespace orbifit {

/// A sampling of the surface whose symmetries are those of the regions (paper, section 5, "Symmetric sampling").
/// Samples are listed orbit by orbit, each orbit's seed first. Where a continuous group acts, copies of one sample
/// stand around its circle (or over its sphere); the first of them, in the canonical place, is the one that counts.
struct SymmetricSampling {
  double radius = 0;                 ///< r, mesh units: every point of a place has a sample of that place within r
  Points points;                     ///< #S by 3; near the surface, on it where nothing snapped them
  Eigen::VectorXd radii;             ///< #S, r at each sample: `radius` but for a radius field
  std::vector<int> orbit_of_sample;  ///< #S
  std::vector<int> first_sample;     ///< of each orbit, and #S at the end
  std::vector<int> words;            ///< #S, from the orbit's seed to the sample's canonical place
  std::vector<int> sets;             ///< #S, the places that hold each sample
  struct Copy {
    int place = -1;  ///< whose continuum turned the canonical sample here; -1: a sample for itself
    int first = -1;  ///< the canonical sample
    Motion turn;
  };
  std::vector<Copy> copies;  ///< #S
  /// #S: for how many samples at distance r each stands; less than 1 where a finite group about the same axis asks for
  /// more copies on a circle than the radius does.
  std::vector<double> shares;
  std::vector<int> copy_counts;  ///< #S: how many stand for the circle of a canonical sample; 1 without continuum
  struct Constraint {
    int orbit;
    int left, right;  ///< words to one place: they must give the same displacement
  };
  std::vector<Constraint> constraints;

  int orbits() const { return static_cast<int>(first_sample.size()) - 1; }
};

struct SamplingOptions {
  double radius = 0;  ///< r, mesh units, > 0
  /// r at each vertex (docs/method.md 2.5), #V, > 0; empty: `radius` everywhere. Images of a sample share its radius.
  Eigen::VectorXd radius_field;
  /// Points to draw first, such as those on sharp features (paper, section 7).
  SurfaceSamples first;
  int most_samples = 40000;
};

/// Symmetric Poisson-disc sampling: seeds are drawn at random from a dense uniform sampling of the surface, each brings
/// its whole orbit, and what lies within r of a sample *of the same places* is not drawn again, so that every region
/// has samples of its own. A seed that its own images crowd (closer than 0.4 r) moves onto the fixed set of the motions
/// that do so, where they coincide. Costs O(candidates + sum over orbits of their size), candidates about 30 a disc.
/// \throw InputError when the mesh has no area, an orbit does not close, or more than most_samples are needed
SymmetricSampling sample_symmetrically(const Mesh& mesh, const RegionMap& regions, GroupWords& words,
                                       const SamplingOptions& options, const RunContext& context);

/// The transports of all samples from their orbits' seeds, given those of the words.
std::vector<Transport> sample_transports(const SymmetricSampling& sampling, const RegionMap& regions,
                                         const std::vector<Transport>& words, bool floating,
                                         const std::vector<Eigen::Matrix3d>& rotations = {});

}  // namespace orbifit

#pragma once

#include <memory>

#include "orbifit/model/run_context.h"

#include "support/found_region.h"
#include "surface/surface_patch.h"

namespace orbifit {

/// Whether what was found on a mesh from which noise was taken out holds on the mesh as it was given, as far as noise
/// lets it: smoothing makes unlike things alike. What noise alone leaves of a symmetry is measured on the smooth
/// surface with fresh noise of the same size.
class NoiseCheck {
 public:
  /// \param given the mesh before the noise was taken out \param clean after; both are kept by reference
  /// \param sigma of the noise, see noise_of() \param tolerance of the detector, a fraction of the diagonal
  NoiseCheck(const PreparedMesh& given, const PreparedMesh& clean, double sigma, double tolerance,
             const RunContext& context);

  /// Shares of a region's area on the mesh as given that all elements of its group keep to the tolerance.
  struct Share {
    double kept;      ///< measured
    double expected;  ///< at least, were there a symmetry and noise: s^N for N elements, s the share of one
  };
  Share share(const FoundRegion& region) const;

  /// Whether the region keeps at least 0.95, or 0.97 of what is expected where that is less.
  bool holds(const FoundRegion& region) const;

 private:
  const PreparedMesh& given_;
  double tolerance_;
  const RunContext& context_;
  std::shared_ptr<const SurfaceIndex> noisy_;  // the smooth surface with fresh noise
};

}  // namespace orbifit

#pragma once

#include <vector>

#include <Eigen/Core>

#include "orbifit/fitting/fit.h"

#include "geometry/sampling.h"
#include "registration/correspondences.h"
#include "scan/scan_preparation.h"
#include "scan/seen_surface.h"

namespace orbifit {

/// How well a surface explains a scan where it lies best.
struct Evidence {
  double error = 0;   ///< mean of robust_error(), squared diagonals
  double missed = 0;  ///< share of the surface that should have been seen and was not
  Similarity move;    ///< rigid: what put the scan onto the surface

  /// Whether a surface with the other evidence explains the scan as well as one with this, but for chance.
  bool as_good(const Evidence& other) const;

  double most_error() const;   ///< that other evidence as good may have
  double most_missed() const;  ///< likewise
};

/// What a scan says of a fitted surface that is stretched, or put elsewhere: of what all it explains the scan as well
/// (docs/method.md 7.2).
class FitEvidence {
 public:
  enum class Asked { explained, all };

  /// \param scan, seen, options  references are kept, and `fitted` \param seen  of the input's scan and the points of
  /// this one \param asked  which points: those that the fitted surface explains, or what it leaves as well
  FitEvidence(const PreparedScan& scan, const SeenSurface& seen, const FitOptions& options, const RunContext& context,
              const Mesh& fitted, Asked asked);

  /// Whether no point is asked.
  bool empty() const { return points_.empty(); }

  /// Of the surface stretched about its centroid along a projection by a share, more than -1; a rigid motion of the
  /// scan follows by ICP. \param start  of that motion
  Evidence of(const Eigen::Matrix3d& along, double share, const Similarity& start = {}) const;

  /// The surface's axes of inertia, one a column.
  Eigen::Matrix3d axes() const;

  const MatchSurface& surface() const { return surface_; }
  const Points& samples() const { return samples_.points; }  ///< of the surface, evenly
  double size() const { return size_; }                      ///< the surface's diagonal
  const std::vector<int>& points() const { return points_; }

 private:
  const PreparedScan& scan_;
  const SeenSurface& seen_;
  MatchSurface surface_;
  Eigen::VectorXd areas_;  // of the faces
  double size_, reach_ = 0;
  std::vector<int> points_;
  SurfaceSamples samples_;
  Eigen::Vector3d centre_;
};

}  // namespace orbifit

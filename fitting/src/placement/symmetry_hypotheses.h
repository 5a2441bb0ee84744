#pragma once

#include <functional>
#include <vector>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"

#include "base/random.h"
#include "geometry/sampling.h"
#include "placement/scan_symmetry.h"

namespace orbifit {

/// The mirror planes of a template's larger regions, and the axes about which they are turned. Of those that a region's
/// own group takes to one another there is one.
std::vector<SymmetryElement> template_symmetries(const Mesh& mesh, const SymmetryAnnotation& annotation);

/// Similarities that bring a plane or an axis of a template onto one of a scan, and one of its oriented points onto one
/// of the scan's: that fixes all, since heights over planes and distances from axes give the scale. Two angles of the
/// point's normal, which no scale changes, say which points of the template it may be. Normals count without their
/// sign.
class SymmetryHypotheses {
 public:
  /// \param samples kept by reference \param own  the template's planes and axes
  SymmetryHypotheses(const SurfaceSamples& samples, std::vector<SymmetryElement> own);

  bool empty() const { return own_.empty(); }

  /// Calls take(pose), template -> scan, for at most `most` poses for each of the template's elements of this kind.
  void propose(const SymmetryElement& of_scan, const Eigen::Vector3d& p, const Eigen::Vector3d& p_normal, int most,
               Random& random, const std::function<void(const Similarity&)>& take) const;

 private:
  const SurfaceSamples& samples_;
  std::vector<SymmetryElement> own_;
  double least_;  // template units: points nearer to a plane or an axis give no scale
};

}  // namespace orbifit

#pragma once

#include <functional>
#include <vector>

#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"

#include "base/random.h"
#include "geometry/sampling.h"

namespace orbifit {

/// Similarities that bring two oriented points of a template onto two of a scan. A pair of points whose normals are not
/// along the line between them fixes a similarity; three angles, which no scale changes, say which pairs of the
/// template it may be (point-pair features of Drost et al. 2010, without the length). Normals count without their sign.
class PoseHypotheses {
 public:
  explicit PoseHypotheses(const SurfaceSamples& samples);

  /// Calls take(pose) for at most `most` poses, template -> scan, that bring a pair of like angles onto the scan's
  /// pair.
  void propose(const Eigen::Vector3d& p, const Eigen::Vector3d& p_normal, const Eigen::Vector3d& q,
               const Eigen::Vector3d& q_normal, int most, Random& random,
               const std::function<void(const Similarity&)>& take) const;

 private:
  struct Pair {
    int first, second;
  };
  const SurfaceSamples& samples_;
  std::vector<std::vector<Pair>> pairs_;  // by angles
};

}  // namespace orbifit

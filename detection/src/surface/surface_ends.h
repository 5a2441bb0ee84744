#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>

#include "orbifit/model/motion.h"

#include "geometry/surface_index.h"
#include "surface/surface_patch.h"

namespace orbifit {

/// The edges with one face, each a face with two corners in one place; null where there are none, and where less than
/// nearly all of the surface hangs together. O(F log F); prepare() asks once.
std::shared_ptr<const SurfaceIndex> end_edges(const PreparedMesh& prepared);

/// Where a surface ends: along edges with one face. What a motion takes past them has no image there, which says
/// nothing against the motion: nobody knows how the surface went on. Of a scene of parts none are asked: a part ends
/// where it was modelled to, or others that are like it tell how it went on.
class SurfaceEnds {
 public:
  /// \param prepared as prepare() made it, but for its components \param tolerance a length; what is nearer an end than four, by which borders are ragged where faces are
  ///                         as large as a search for them allows, is near it
  SurfaceEnds(const PreparedMesh& prepared, double tolerance);

  /// Whether one of the motions takes a point of the normalised mesh near an end. O(log F) each
  bool taken_near(const Eigen::Vector3d& point, const std::vector<Motion>& motions) const;

  /// Whether a point off the surface is past an end, so that nothing of the surface is nearer to it, that one of the
  /// motions does not take to an end: where more of the surface may have been. What all take to ends is a border of its
  /// own. O(log F) each
  /// \param whole index of the surface
  bool past_broken_end(const Eigen::Vector3d& point, const SurfaceIndex& whole,
                       const std::vector<Motion>& motions) const;

 private:
  bool near(const Eigen::Vector3d& point) const;

  double tolerance_;
  std::shared_ptr<const SurfaceIndex> edges_;  // end_edges()
};

}  // namespace orbifit

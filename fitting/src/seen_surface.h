#pragma once

#include <vector>

#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"
#include "orbifit/model/point_index.h"
#include "orbifit/model/sampling.h"
#include "orbifit/model/surface_index.h"

namespace orbifit {

/// What a scan's viewpoints see, and so what of a posed template they should have seen.
class SeenSurface {
 public:
  /// \param points, viewpoints  #P by 3 each, or viewpoints 1 by 3 or 0 by 3 where unknown
  SeenSurface(const Points& points, const Points& viewpoints);

  /// Of the template's surface that the viewpoints have before them, not behind the template itself nor behind
  /// something else, the share at which the scan has points; of all of it where no viewpoint is known. Less where
  /// little of the template is seen at all.
  /// \param samples, surface  the template's \param pose template -> scan \param reach scan units
  double covered(const SurfaceSamples& samples, const SurfaceIndex& surface, const Similarity& pose,
                 double reach) const;

  bool knows_viewpoints() const { return !views_.empty(); }

 private:
  /// A picture of depths: in each pixel the least and the largest distance of a point from the viewpoint.
  struct View {
    Eigen::Vector3d eye;
    Eigen::Matrix3d frame;  ///< columns: right, up, forwards
    double half_width;      ///< of the picture at distance 1
    int pixels;             ///< along each side
    std::vector<float> nearest, farthest;

    int pixel_of(const Eigen::Vector3d& point) const;  ///< -1 outside
  };
  enum class Sight { seen, missed, hidden };
  Sight look(const View& view, const Eigen::Vector3d& point, double reach) const;

  std::vector<View> views_;
  PointIndex index_;
};

}  // namespace orbifit

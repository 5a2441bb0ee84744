#pragma once

#include <vector>

#include <Eigen/Core>

#include "orbifit/datasets_tools/symmetry_residual.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"

namespace orbifit {

/// Where a rigid motion takes deformed points, told from a region's centre in the rest shape:
/// y -> rotation (y - pivot) + offset. Near the region no digits are lost, however far it is from the origin.
struct CarriedFrame {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d pivot = Eigen::Vector3d::Zero();
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();

  Eigen::Vector3d operator()(const Eigen::Vector3d& point) const { return rotation * (point - pivot) + offset; }
};

/// Deformed places of points p and of the points q that `element` puts them on at rest.
struct ElementSample {
  Motion element;  ///< told from the region's centre
  Points p, q;     ///< #S by 3 each
};

struct RegionSample {
  Eigen::Vector3d centre;  ///< the region's, at rest
  std::vector<ElementSample> elements;
};

struct CarriedFit {
  std::vector<CarriedFrame> frames;  ///< one a region
  double energy = 0;                 ///< sum of squared distances
  bool exact = false;                ///< no more is left than rounding leaves
};

/// The frames N that make the sum of |g N y(p) - N y(q)|^2 least, by Levenberg and Marquardt's method from `start`,
/// iterated until rounding stops it, or nothing but rounding is left. `mode` is posed, floating or moving.
/// \param scale a length of the shape's size
CarriedFit fit_carried_frames(const std::vector<RegionSample>& regions, CarriedMotions mode, double scale,
                              const Motion& start);

/// The rotation and translation that put the rows of `from` nearest to those of `to`, in the least-squares sense.
Motion best_rigid_motion(const Points& from, const Points& to);

}  // namespace orbifit

#pragma once

#include <string_view>
#include <vector>

#include "orbifit/model/run_context.h"

#include "primitives/revolution.h"
#include "scan/point_surface.h"

namespace orbifit {

/// Points of a scan that lie on one surface of revolution, of which perhaps only one side was seen.
struct PartialRevolution {
  Line axis;                ///< its point is the foot of the points' centroid
  std::vector<int> points;  ///< kept points, ascending
  double arc = 0;           ///< radians about the axis that are seen without a gap
  double rms = 0;           ///< distance of the points from their mean profile
};

/// The surface of revolution that most of some points lie on. Where only one side is seen, turning takes what is seen
/// to where nothing is, so nothing is turned: points are drawn in the half-plane of distance along and from the axis,
/// where those of a surface of revolution fall on one curve, the profile, whatever their angle. A point belongs when
/// its normal meets the axis and it is within the tolerance of the mean profile about it. Axes are proposed by fits to
/// the normals (fit_axis_of_revolution) of random neighbourhoods, and refined by Gauss-Newton steps on the distances
/// from the profile.
/// \param among kept points, ascending
/// \param tolerance a length
/// \param stream name of the random stream
/// \return no points when fewer than `least_share` belong, the seen arc is below 70 degrees, or much around them does
/// not belong
PartialRevolution find_partial_revolution(const PointSurface& surface, const std::vector<int>& among, double tolerance,
                                          double least_share, const RunContext& context, std::string_view stream);

}  // namespace orbifit

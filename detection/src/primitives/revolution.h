#pragma once

#include <optional>

#include <Eigen/Core>

#include "orbifit/model/mesh.h"

namespace orbifit {

/// A line in space.
struct Line {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< unit
};

/// Whether the normal meets the axis, as on every surface turned about it: within asin(0.2) of the half-plane through
/// the point. \param normal unit \param near a distance from the axis within which any normal does
bool meets(const Line& axis, const Eigen::Vector3d& point, const Eigen::Vector3d& normal, double near = 0);

struct RevolutionFit {
  Line axis;
  double inliers = 0;      ///< share of the weight whose normals meet the axis within the angle asked for
  bool planar = false;     ///< all normals are parallel: the axis is their direction through the centroid, a guess
  bool spherical = false;  ///< the normals meet in a point: every line through it is an axis
};

/// Radians by which normals of a surface of revolution may miss its axis where nothing else is known of it.
inline constexpr double kRevolutionAngle = 0.1;

/// The axis about which oriented points turn into themselves: every normal meets the axis of a surface of revolution,
/// so n . (v + w x p) = 0 for its infinitesimal rotation (v, w), a linear complex without pitch (Pottmann and Randrup
/// 1998). Weighted least squares in w and v with |w| = 1, reweighted by the speed |v + w x p|, which turns the residual
/// into the sine of the angle to the tangent plane, and by Tukey's loss.
/// \param points, normals #S by 3; normals unit \param weights #S, >= 0, or empty for equal ones
/// \param angle of the loss, radians: normals further off are outliers
/// \return nothing for fewer than 6 points, or when no rotation leaves half the weight within the angle
std::optional<RevolutionFit> fit_axis_of_revolution(const Points& points, const Points& normals,
                                                    const Eigen::VectorXd& weights, double angle);

}  // namespace orbifit

#pragma once

#include <Eigen/Core>

namespace orbifit {

/// A Euclidean motion p -> linear p + translation, linear orthogonal with determinant +1 or -1.
struct Motion {
  Eigen::Matrix3d linear = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  Eigen::Vector3d operator()(const Eigen::Vector3d& point) const { return linear * point + translation; }

  static Motion about(const Eigen::Matrix3d& linear, const Eigen::Vector3d& fixed_point);
  static Motion rotation(const Eigen::Vector3d& axis, double radians, const Eigen::Vector3d& point_on_axis);
  static Motion reflection(const Eigen::Vector3d& normal, const Eigen::Vector3d& point_on_plane);
};

/// First b, then a.
Motion operator*(const Motion& a, const Motion& b);

Motion inverse(const Motion& motion);

/// frame * motion * frame^-1: the motion as seen after moving the world by `frame`.
Motion conjugate(const Motion& frame, const Motion& motion);

/// Largest entry of |linear linear^T - 1|.
double orthogonality_error(const Eigen::Matrix3d& linear);

/// The orthogonal matrix nearest to `matrix`, of either determinant (polar decomposition).
Eigen::Matrix3d nearest_orthogonal(const Eigen::Matrix3d& matrix);

/// Largest distance between the images of points within `reach` of `centre`: a length, comparable to tolerances.
double motion_distance(const Motion& a, const Motion& b, const Eigen::Vector3d& centre, double reach);

/// Rotation about the unit axis by Rodrigues' formula.
Eigen::Matrix3d axis_rotation(const Eigen::Vector3d& axis, double radians);

/// Determinant, angle in [0, pi] and unit axis of linear = det * rotation(axis, angle); zero axis for angle 0.
struct AxisAngle {
  int determinant = 1;
  double angle = 0;  ///< of det * linear, radians
  Eigen::Vector3d axis = Eigen::Vector3d::Zero();
};
AxisAngle axis_angle(const Eigen::Matrix3d& linear);

/// A similarity p -> scale * linear p + translation; carries a template into a scan's frame.
struct Similarity {
  double scale = 1;  ///< > 0
  Eigen::Matrix3d linear = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  Eigen::Vector3d operator()(const Eigen::Vector3d& point) const { return scale * (linear * point) + translation; }
};

Similarity operator*(const Similarity& a, const Similarity& b);
Similarity inverse(const Similarity& similarity);

/// similarity * motion * similarity^-1, again a Euclidean motion.
Motion conjugate(const Similarity& similarity, const Motion& motion);

}  // namespace orbifit

#include "orbifit/model/motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/LU>

#include "base/dense.h"

namespace orbifit {

Motion Motion::about(const Eigen::Matrix3d& linear, const Eigen::Vector3d& fixed_point) {
  return {linear, fixed_point - linear * fixed_point};
}

Motion Motion::rotation(const Eigen::Vector3d& axis, double radians, const Eigen::Vector3d& point_on_axis) {
  return about(axis_rotation(axis, radians), point_on_axis);
}

Motion Motion::reflection(const Eigen::Vector3d& normal, const Eigen::Vector3d& point_on_plane) {
  const Eigen::Vector3d n = normal.normalized();
  return about(Eigen::Matrix3d::Identity() - 2 * n * n.transpose(), point_on_plane);
}

Motion operator*(const Motion& a, const Motion& b) {
  return {a.linear * b.linear, a.linear * b.translation + a.translation};
}

Motion inverse(const Motion& motion) {
  return {motion.linear.transpose(), -(motion.linear.transpose() * motion.translation)};
}

Motion conjugate(const Motion& frame, const Motion& motion) {
  return frame * motion * inverse(frame);
}

double orthogonality_error(const Eigen::Matrix3d& linear) {
  return (linear * linear.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
}

Eigen::Matrix3d nearest_orthogonal(const Eigen::Matrix3d& matrix) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return svd.matrixU() * svd.matrixV().transpose();
}

double motion_distance(const Motion& a, const Motion& b, const Eigen::Vector3d& centre, double reach) {
  // |(A - B)(c + r)| <= |(A - B) c| + |A - B|_F |r|
  return (a(centre) - b(centre)).norm() + reach * (a.linear - b.linear).norm();
}

Eigen::Matrix3d axis_rotation(const Eigen::Vector3d& axis, double radians) {
  Eigen::Matrix3d cross;
  cross << 0, -axis.z(), axis.y(), axis.z(), 0, -axis.x(), -axis.y(), axis.x(), 0;
  return Eigen::Matrix3d::Identity() + std::sin(radians) * cross + (1 - std::cos(radians)) * cross * cross;
}

AxisAngle axis_angle(const Eigen::Matrix3d& linear) {
  AxisAngle result;
  result.determinant = linear.determinant() > 0 ? 1 : -1;
  const Eigen::Matrix3d rotation = result.determinant * linear;
  const Eigen::Vector3d skew(rotation(2, 1) - rotation(1, 2), rotation(0, 2) - rotation(2, 0),
                             rotation(1, 0) - rotation(0, 1));
  const double sine = skew.norm() / 2;
  const double cosine = (rotation.trace() - 1) / 2;
  result.angle = std::atan2(sine, cosine);
  if (cosine > 0 || sine > 1e-3) {
    if (sine > 0) result.axis = skew / (2 * sine);
    return result;
  }
  // Near half a turn the skew part vanishes: the axis is the eigenvector of 1 of the symmetric part.
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver((rotation + rotation.transpose()) / 2);
  result.axis = solver.eigenvectors().col(2);
  if (result.axis.dot(skew) < 0) result.axis = -result.axis;
  return result;
}

Similarity operator*(const Similarity& a, const Similarity& b) {
  return {a.scale * b.scale, a.linear * b.linear, a(b.translation)};
}

Similarity inverse(const Similarity& similarity) {
  const Eigen::Matrix3d back = similarity.linear.transpose();
  return {1 / similarity.scale, back, -(back * similarity.translation) / similarity.scale};
}

Motion conjugate(const Similarity& similarity, const Motion& motion) {
  // s R (O R^T (p - t) / s + m) + t = R O R^T p + (t - R O R^T t + s R m)
  const Eigen::Matrix3d linear = similarity.linear * motion.linear * similarity.linear.transpose();
  return {linear, similarity.translation - linear * similarity.translation +
                      similarity.scale * (similarity.linear * motion.translation)};
}

}  // namespace orbifit

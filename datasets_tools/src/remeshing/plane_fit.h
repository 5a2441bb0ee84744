#pragma once

#include <Eigen/Core>

namespace orbifit {

/// Planes of a surface near a point, and the point that is on all of them as nearly as can be (quadratic error
/// function: Ju et al. 2002, equation 1).
class PlaneFit {
 public:
  /// The plane through `point` across the unit normal; a zero normal adds the point to the mean only.
  void add(const Eigen::Vector3d& point, const Eigen::Vector3d& normal, double weight) {
    normals_ += weight * normal * normal.transpose();
    offsets_ += weight * normal.dot(point) * normal;
    points_ += weight * point;
    weight_ += weight;
  }

  double weight() const { return weight_; }
  Eigen::Vector3d mean() const { return points_ / weight_; }

  /// The point of the box that minimises the mean squared distance to the planes, plus a small part of that to `start`,
  /// which decides where the planes leave it free.
  Eigen::Vector3d nearest_to(const Eigen::Vector3d& start, const Eigen::Vector3d& low, const Eigen::Vector3d& high,
                             double pull = 1e-3) const;

 private:
  Eigen::Matrix3d normals_ = Eigen::Matrix3d::Zero();
  Eigen::Vector3d offsets_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d points_ = Eigen::Vector3d::Zero();
  double weight_ = 0;
};

}  // namespace orbifit

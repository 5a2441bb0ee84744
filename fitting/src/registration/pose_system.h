#pragma once

#include <algorithm>

#include <Eigen/Core>

#include "orbifit/model/motion.h"

#include "base/dense.h"
#include "registration/alignment.h"

namespace orbifit {

/// Point-to-plane offsets as a linear system in a small similarity of the scan in the template's frame: a rotation
/// about the pivot and the growth times the template's diagonal, and a translation.
class PoseSystem {
 public:
  PoseSystem(double size, const Eigen::Vector3d& pivot) : size_(size), pivot_(pivot) {}

  /// A scan point, the surface's normal near it, and how far along the normal the surface is.
  void add(const Eigen::Vector3d& point, const Eigen::Vector3d& normal, double offset, double weight) {
    const Eigen::Vector3d arm = point - pivot_;
    Vector7 row;
    row << arm.cross(normal) / size_, normal, normal.dot(arm) / size_;
    matrix_ += weight * row * row.transpose();
    side_ += weight * offset * row;
  }

  struct Step {
    Similarity scan;  ///< to apply to the scan in the template's frame
    double length;    ///< template units
  };

  /// What the scan leaves open, such as a turn about a lathe part's axis, stays.
  Step rigid() const {
    Matrix6d matrix = matrix_.topLeftCorner<6, 6>();
    matrix.diagonal().array() += kOpen * matrix.trace();
    Vector7 step = Vector7::Zero();
    step.head<6>() = solve_semidefinite(matrix, side_.head<6>());
    return step_of(step);
  }

  Step scaled() const {
    Eigen::MatrixXd matrix = matrix_;
    const double trace = matrix.trace();
    matrix.diagonal().array() += kOpen * trace;
    matrix(6, 6) += kScaleDamping * trace;
    return step_of(solve_semidefinite(matrix, side_));
  }

 private:
  using Vector7 = Eigen::Matrix<double, 7, 1>;
  static constexpr double kOpen = 1e-6;
  static constexpr double kScaleDamping = 0.02;  // a scan of little else than a plane says nothing of the scale

  Step step_of(const Vector7& step) const {
    const Motion motion = small_motion(step.head<3>() / size_, step.segment<3>(3), pivot_);
    const double growth = std::clamp(1 + step[6] / size_, 0.8, 1.25);
    return {{growth, motion.linear, motion(pivot_) - growth * (motion.linear * pivot_)}, step.norm()};
  }

  double size_;
  Eigen::Vector3d pivot_;
  Eigen::Matrix<double, 7, 7> matrix_ = Eigen::Matrix<double, 7, 7>::Zero();
  Vector7 side_ = Vector7::Zero();
};

}  // namespace orbifit

#include "remeshing/plane_fit.h"

#include <algorithm>

#include <Eigen/Cholesky>

namespace orbifit {

Eigen::Vector3d PlaneFit::nearest_to(const Eigen::Vector3d& start, const Eigen::Vector3d& low,
                                     const Eigen::Vector3d& high, double pull) const {
  // Told from the start, so that no digits are lost far from the origin.
  Eigen::Matrix3d matrix = normals_ / weight_;
  const Eigen::Vector3d right = offsets_ / weight_ - matrix * start;
  matrix.diagonal().array() += pull;
  Eigen::Vector3d step = matrix.ldlt().solve(right);
  const Eigen::Vector3d least = low - start;
  const Eigen::Vector3d most = high - start;
  if ((step.array() >= least.array()).all() && (step.array() <= most.array()).all()) return start + step;
  // A convex function in a box: one coordinate after the other.
  step = step.cwiseMax(least).cwiseMin(most);
  for (int pass = 0; pass < 40; ++pass) {
    for (Eigen::Index k = 0; k < 3; ++k) {
      const double rest = right[k] - matrix.row(k).dot(step) + matrix(k, k) * step[k];
      step[k] = std::clamp(rest / matrix(k, k), least[k], most[k]);
    }
  }
  return start + step;
}

}  // namespace orbifit

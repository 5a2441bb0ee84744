#include "geometry/fitted_plane.h"

#include "base/dense.h"

namespace orbifit {

using Eigen::Matrix3d;
using Eigen::Vector3d;

FittedPlane fitted_plane(const Points& points, const std::vector<int>& chosen) {
  const auto count = static_cast<double>(chosen.size());
  Vector3d mean = Vector3d::Zero();
  for (const int i : chosen) mean += points.row(i).transpose();
  mean /= count;
  Matrix3d covariance = Matrix3d::Zero();
  for (const int i : chosen) {
    const Vector3d offset = points.row(i).transpose() - mean;
    covariance += offset * offset.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Matrix3d> axes(covariance / count);
  return {axes.eigenvectors().col(0), mean, axes.eigenvalues().cwiseMax(0).cwiseSqrt()};
}

}  // namespace orbifit

#include "solver/corotated_energy.h"

#include <algorithm>
#include <utility>

namespace orbifit {

CorotatedEnergy::CorotatedEnergy(const Points& samples, double radius, double stretch)
    : corotation_(corotation(samples, 2 * radius)),
      sums_(corotation_),
      degree_(std::max(1.0, corotation_.laplacian.diagonal().mean())),
      stretch_(stretch / degree_),
      rotations_(static_cast<std::size_t>(samples.rows()), Eigen::Matrix3d::Identity()) {
  corotation_.laplacian /= degree_;
  corotation_.delta /= degree_;
}

Eigen::SparseMatrix<double> CorotatedEnergy::matrix() const {
  const Eigen::SparseMatrix<double> bending = corotation_.laplacian.transpose() * corotation_.laplacian;
  const Eigen::SparseMatrix<double> stretching = corotation_.laplacian * (degree_ * stretch_);
  return bending + stretching;
}

Points CorotatedEnergy::pull() const {
  const FourMatrices rotations = in_fours(rotations_);
  Points result = corotated_pull(corotation_, rotations_);
  for (Eigen::Index i = 0; i < result.rows(); ++i) {
    result.row(i) += stretch_ * sums_.turned(static_cast<int>(i), rotations).transpose();
  }
  return result;
}

double CorotatedEnergy::value(const Points& displacements) const {
  const FourMatrices rotations = in_fours(rotations_);
  const FourRows moved = in_fours(displacements);
  double stretching = 0;
  for (Eigen::Index i = 0; i < displacements.rows(); ++i) {
    stretching += sums_.squared_residual(static_cast<int>(i), rotations, moved);
  }
  // Each edge was met from both of its ends.
  return laplace_energy(corotation_, rotations_, displacements) + stretch_ * 0.5 * stretching;
}

double CorotatedEnergy::of_growth() const {
  double stretching = 0;
  for (Eigen::Index i = 0; i < samples(); ++i) stretching += 0.5 * sums_.size(static_cast<int>(i));
  return corotation_.delta.squaredNorm() + stretch_ * stretching;
}

void CorotatedEnergy::rotate(const Points& displacements) {
  const FourRows moved = in_fours(displacements);
  std::vector<Eigen::Matrix3d> covariances;
  std::vector<double> sizes;
  for (int i = 0; i < static_cast<int>(samples()); ++i) {
    covariances.push_back(sums_.covariance(i, moved));
    sizes.push_back(sums_.size(i));
  }
  turn_locally(std::move(covariances), sizes, rotations_);
}

}  // namespace orbifit

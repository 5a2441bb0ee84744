#include "solver/corotated_energy.h"

#include <algorithm>
#include <utility>

namespace orbifit {

namespace {

Corotation moved_corotation(const Points& samples, double radius, const Points& moved) {
  Corotation result = corotation(samples, 2 * radius);
  if (moved.rows() == 0) return result;
  result.rest += moved;
  result.delta = result.laplacian * result.rest;
  return result;
}

}  // namespace

CorotatedEnergy::CorotatedEnergy(const Points& samples, double radius, double stretch, const Points& moved,
                                 double anchor)
    : corotation_(moved_corotation(samples, radius, moved)),
      sums_(corotation_),
      degree_(std::max(1.0, corotation_.laplacian.diagonal().mean())),
      stretch_(stretch / degree_),
      anchor_(anchor),
      rotations_(static_cast<std::size_t>(samples.rows()), Eigen::Matrix3d::Identity()) {
  corotation_.laplacian /= degree_;
  corotation_.delta /= degree_;
}

Eigen::SparseMatrix<double> CorotatedEnergy::matrix() const {
  const Eigen::SparseMatrix<double> bending = corotation_.laplacian.transpose() * corotation_.laplacian;
  const Eigen::SparseMatrix<double> stretching = corotation_.laplacian * (degree_ * stretch_);
  const Eigen::SparseMatrix<double> anchor(Eigen::VectorXd::Constant(samples(), anchor_).asDiagonal());
  return bending + stretching + anchor;
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
  return laplace_energy(corotation_, rotations_, displacements) + stretch_ * 0.5 * stretching +
         anchor_ * displacements.squaredNorm();
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

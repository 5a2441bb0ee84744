#include "corotated_energy.h"

#include <algorithm>

namespace orbifit {

namespace {

// Sum over neighbours of (R_i + R_j) / 2 (x_i - x_j) less the same unrotated: what stretching pulls towards.
Points stretch_pull(const Corotation& corotation, const std::vector<Eigen::Matrix3d>& rotations) {
  Points pull = Points::Zero(corotation.rest.rows(), 3);
  for (std::size_t i = 0; i < rotations.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    for (const int j : corotation.neighbours[i]) {
      if (j <= static_cast<int>(i)) continue;
      const Eigen::Vector3d edge = (corotation.rest.row(row) - corotation.rest.row(j)).transpose();
      const Eigen::Matrix3d mean = 0.5 * (rotations[i] + rotations[static_cast<std::size_t>(j)]);
      const Eigen::Vector3d turned = mean * edge - edge;
      pull.row(row) += turned.transpose();
      pull.row(j) -= turned.transpose();
    }
  }
  return pull;
}

}  // namespace

CorotatedEnergy::CorotatedEnergy(const Points& samples, double radius, double stretch)
    : corotation_(corotation(samples, 2 * radius)),
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
  return corotated_pull(corotation_, rotations_) + stretch_ * stretch_pull(corotation_, rotations_);
}

double CorotatedEnergy::value(const Points& displacements) const {
  double stretching = 0;
  for (std::size_t i = 0; i < rotations_.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    for (const int j : corotation_.neighbours[i]) {
      if (j <= static_cast<int>(i)) continue;
      const Eigen::Vector3d edge = (corotation_.rest.row(row) - corotation_.rest.row(j)).transpose();
      const Eigen::Vector3d now = edge + (displacements.row(row) - displacements.row(j)).transpose();
      stretching += (now - 0.5 * (rotations_[i] + rotations_[static_cast<std::size_t>(j)]) * edge).squaredNorm();
    }
  }
  return laplace_energy(corotation_, rotations_, displacements) + stretch_ * stretching;
}

double CorotatedEnergy::of_growth() const {
  double stretching = 0;
  for (std::size_t i = 0; i < rotations_.size(); ++i) {
    for (const int j : corotation_.neighbours[i]) {
      stretching += 0.5 * (corotation_.rest.row(static_cast<Eigen::Index>(i)) - corotation_.rest.row(j)).squaredNorm();
    }
  }
  return corotation_.delta.squaredNorm() + stretch_ * stretching;
}

void CorotatedEnergy::rotate(const Points& displacements) {
  rotations_ = local_rotations(corotation_, corotation_.rest + displacements, rotations_);
}

}  // namespace orbifit

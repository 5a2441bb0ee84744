#include "deformation/neighbour_sums.h"

#include "kernels/kernels.h"

namespace orbifit {

FourRows in_fours(const Points& rows) {
  FourRows result(4, rows.rows());
  result.topRows<3>() = rows.transpose();
  result.row(3).setZero();
  return result;
}

FourMatrices in_fours(const std::vector<Eigen::Matrix3d>& matrices) {
  FourMatrices result(12, static_cast<Eigen::Index>(matrices.size()));
  for (std::size_t i = 0; i < matrices.size(); ++i) {
    double* to = result.col(static_cast<Eigen::Index>(i)).data();
    for (int k = 0; k < 3; ++k, to += 4) {
      for (int c = 0; c < 3; ++c) to[c] = matrices[i](c, k);
      to[3] = 0;
    }
  }
  return result;
}

NeighbourSums::NeighbourSums(const Corotation& corotation) {
  const Points& rest = corotation.rest;
  for (const std::vector<int>& neighbours : corotation.neighbours) {
    first_.push_back(static_cast<int>(end_.size()));
    end_.insert(end_.end(), neighbours.begin(), neighbours.end());
  }
  first_.push_back(static_cast<int>(end_.size()));
  edges_.setZero(4, static_cast<Eigen::Index>(end_.size()));
  sums_.setZero(4, rest.rows());
  for (Eigen::Index i = 0; i < rest.rows(); ++i) {
    const auto at = static_cast<std::size_t>(i);
    double size = 0;
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (int e = first_[at]; e < first_[at + 1]; ++e) {
      const Eigen::Vector3d edge = (rest.row(i) - rest.row(end_[static_cast<std::size_t>(e)])).transpose();
      edges_.col(e).head<3>() = edge;
      sums_.col(i).head<3>() += edge;
      size += edge.squaredNorm();
      covariance += edge * edge.transpose();
    }
    sizes_.push_back(size);
    rest_.push_back(covariance);
  }
}

Eigen::Matrix3d NeighbourSums::covariance(int sample, const FourRows& displacements) const {
  const auto i = static_cast<std::size_t>(sample);
  double sum[12];
  kernels().edge_products(edges_.data() + std::ptrdiff_t{4} * first_[i], end_.data() + first_[i], count(i),
                          displacements.data(), sum);
  // (u_i - u_j) e^T
  Eigen::Matrix3d result = rest_[i];
  for (int k = 0; k < 3; ++k) {
    for (int c = 0; c < 3; ++c) result(c, k) += displacements(c, sample) * sums_(k, sample) - sum[4 * k + c];
  }
  return result;
}

Eigen::Vector3d NeighbourSums::turned(int sample, const FourMatrices& rotations) const {
  const auto i = static_cast<std::size_t>(sample);
  double sum[4];
  kernels().turned_edges(edges_.data() + std::ptrdiff_t{4} * first_[i], end_.data() + first_[i], count(i),
                         rotations.data(), sum);
  const double* here = rotations.col(sample).data();
  Eigen::Vector3d result;
  for (int c = 0; c < 3; ++c) {
    const double own = here[c] * sums_(0, sample) + here[4 + c] * sums_(1, sample) + here[8 + c] * sums_(2, sample);
    result[c] = 0.5 * (own + sum[c]) - sums_(c, sample);
  }
  return result;
}

double NeighbourSums::squared_residual(int sample, const FourMatrices& rotations, const FourRows& displacements) const {
  const auto i = static_cast<std::size_t>(sample);
  return kernels().edge_residuals(edges_.data() + std::ptrdiff_t{4} * first_[i], end_.data() + first_[i], count(i),
                                  rotations.data(), displacements.data(), rotations.col(sample).data(),
                                  displacements.col(sample).data());
}

}  // namespace orbifit

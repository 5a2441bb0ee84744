#pragma once

#include <functional>

#include <Eigen/Core>

namespace orbifit {

using LinearMap = std::function<Eigen::VectorXd(const Eigen::VectorXd&)>;

/// Estimate of the 2-norm of a symmetric linear map: power iteration, always from the same vector. From below, mostly
/// to a percent. \param size of its vectors
double norm_estimate(Eigen::Index size, const LinearMap& map);

/// Estimate of the 2-norm condition number of a symmetric matrix. \param solve applies its inverse
double condition_estimate(Eigen::Index size, const LinearMap& multiply, const LinearMap& solve);

}  // namespace orbifit

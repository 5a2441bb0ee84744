#pragma once

#include <functional>

#include <Eigen/Core>

namespace orbifit {

using LinearMap = std::function<Eigen::VectorXd(const Eigen::VectorXd&)>;

/// Estimate of the 2-norm of a symmetric linear map by power iteration: from below, mostly to a percent.
/// \param start any vector with a part in the direction that grows most
double norm_estimate(Eigen::VectorXd start, const LinearMap& map);

/// Estimate of the 2-norm condition number of a symmetric matrix, or of a singular one on its range. Deterministic.
/// \param solve applies its inverse to vectors of its range, with results in its range
double condition_estimate(Eigen::Index size, const LinearMap& multiply, const LinearMap& solve);

}  // namespace orbifit

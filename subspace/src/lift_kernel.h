#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "orbifit/subspace/orbit_lift.h"

namespace orbifit {

/// Rows of three as rows of four, the last zero, so that a row is one aligned vector.
std::vector<double> padded_by_four(const Eigen::VectorXd& stacked);

/// For representatives begin ... end - 1: the weighted sums of the atoms' displacements, written to result[3 r ...].
void weighted_sums(const OrbitLift& lift, const std::vector<double>& atoms, std::size_t begin, std::size_t end,
                   double* result);

}  // namespace orbifit

#include "solver/condition.h"

#include <cmath>

#include "base/random.h"

namespace orbifit {

double norm_estimate(Eigen::VectorXd start, const LinearMap& map) {
  constexpr int kMaxSteps = 200;
  constexpr int kMinSteps = 8;
  constexpr double kConverged = 1e-4;
  double norm = 0;
  for (int step = 0; step < kMaxSteps && start.norm() > 0; ++step) {
    start = map(start.normalized());
    const double before = norm;
    norm = start.norm();
    if (step >= kMinSteps && std::abs(norm - before) < kConverged * norm) break;
  }
  return norm;
}

double condition_estimate(Eigen::Index size, const LinearMap& multiply, const LinearMap& solve) {
  Random random(1, "condition estimate");
  Eigen::VectorXd vector(size);
  for (double& entry : vector) entry = random.normal();
  return norm_estimate(vector, multiply) * norm_estimate(multiply(vector), solve);
}

}  // namespace orbifit

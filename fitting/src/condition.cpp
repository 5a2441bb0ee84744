#include "condition.h"

#include <cmath>

#include "orbifit/model/random.h"

namespace orbifit {

double norm_estimate(Eigen::Index size, const LinearMap& map) {
  constexpr int kMostSteps = 200;
  constexpr double kSettled = 1e-4;
  Random random(1, "norm estimate");
  Eigen::VectorXd vector(size);
  for (double& entry : vector) entry = random.normal();
  double norm = 0;
  for (int step = 0; step < kMostSteps && vector.norm() > 0; ++step) {
    vector = map(vector.normalized());
    const double before = norm;
    norm = vector.norm();
    if (std::abs(norm - before) < kSettled * norm) break;
  }
  return norm;
}

double condition_estimate(Eigen::Index size, const LinearMap& multiply, const LinearMap& solve) {
  return norm_estimate(size, multiply) * norm_estimate(size, solve);
}

}  // namespace orbifit

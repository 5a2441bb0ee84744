#include "basis/bessel.h"

#include <cmath>
#include <numbers>

namespace orbifit {

GaussianAverage circle_average(double kappa) {
  constexpr double kLarge = 200;
  if (kappa > kLarge) {  // Abramowitz and Stegun 9.7.1
    const double x = 1 / (8 * kappa);
    const double i0 = 1 + x * (1 + x * (4.5 + x * (37.5 + x * 459.375)));
    const double i1 = 1 - x * (3 + x * (7.5 + x * (52.5 + x * 590.625)));
    return {i0 / std::sqrt(2 * std::numbers::pi * kappa), i1 / i0};
  }
  const double i0 = std::cyl_bessel_i(0.0, kappa);
  return {std::exp(-kappa) * i0, std::cyl_bessel_i(1.0, kappa) / i0};
}

GaussianAverage sphere_average(double kappa) {
  constexpr double kSmall = 1e-3;
  if (kappa < kSmall) return {1 - kappa + 2 * kappa * kappa / 3, kappa / 3};
  return {-std::expm1(-2 * kappa) / (2 * kappa), 1 / std::tanh(kappa) - 1 / kappa};
}

}  // namespace orbifit

#pragma once

namespace orbifit {

/// The average of a Gaussian around a circle or over a sphere, relative to its value nearest by, and how much less of a
/// radial displacement it leaves than of an axial one (docs/method.md 2.4), with kappa = rho rho_s / sigma^2 >= 0.
struct GaussianAverage {
  double weight = 1;  ///< circle: exp(-kappa) I0(kappa); sphere: exp(-kappa) sinh(kappa) / kappa
  double ratio = 0;   ///< circle: I1 / I0; sphere: coth(kappa) - 1 / kappa
};

GaussianAverage circle_average(double kappa);
GaussianAverage sphere_average(double kappa);

}  // namespace orbifit

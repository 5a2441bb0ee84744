#include "orbifit/baselines/kurz.h"

#include <chrono>
#include <cmath>
#include <string>
#include <utility>

#include "orbifit/model/errors.h"

#include "assessment/fit_assessment.h"
#include "kurz_fit.h"
#include "unit_input.h"

namespace orbifit {

namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

void KurzOptions::validate() const {
  require(handle_weight >= 0, "handle_weight", handle_weight, "0 or more");
  require(data_weight >= 0, "data_weight", data_weight, "0 or more");
  require(thin_plate_weight > 0, "thin_plate_weight", thin_plate_weight, "positive");
  require(symmetry_weight >= 0, "symmetry_weight", symmetry_weight, "0 or more");
  require(spacing > 0 && spacing <= 1, "spacing", spacing, "in (0, 1]");
  require(linear_iterations >= 1, "linear_iterations", linear_iterations, "at least 1");
  require(smooth_iterations >= 0, "smooth_iterations", smooth_iterations, "at least 0");
  require(stiff_iterations >= 0, "stiff_iterations", stiff_iterations, "at least 0");
  require(first_thin_plate >= thin_plate_weight, "first_thin_plate", first_thin_plate, "at least thin_plate_weight");
  require(still >= 0, "still", still, "0 or more");
  require(quadrature_points >= 64, "quadrature_points", quadrature_points, "at least 64");
  require(trim > 0 && trim <= 1, "trim", trim, "in (0, 1]");
  require(never_trim >= 0, "never_trim", never_trim, "0 or more");
  require(min_normal_cosine >= 0 && min_normal_cosine < 1, "min_normal_cosine", min_normal_cosine, "in [0, 1)");
  require(scan_points >= 10, "scan_points", scan_points, "at least 10");
  require(inlier_distance > 0, "inlier_distance", inlier_distance, "positive");
}

FitResult fit_kurz(const FitInput& input, const KurzOptions& options, const RunContext& context) {
  options.validate();
  auto start = std::chrono::steady_clock::now();
  const UnitInput unit = unit_input(input, options, context);
  KurzFit fit(input, unit, options, context);
  const double prepared = seconds_since(start);
  start = std::chrono::steady_clock::now();
  fit.run(GridBasis::linear, options.linear_iterations);
  const auto smooth = std::chrono::steady_clock::now();
  if (options.smooth_iterations > 0) fit.run(GridBasis::cubic, options.smooth_iterations);
  FitResult result = std::move(fit).result();
  result.times = {{"prepare", prepared}, {"fit", seconds_since(start)}, {"smooth", seconds_since(smooth)}};
  result.converged = true;
  if (unit.points.rows() == 0) {
    result.landmark_rms = pulls_rms(input, result);
    return result;
  }
  FitOptions assessment;
  assessment.inlier_distance = options.inlier_distance;
  assess_fit(input, unit.scan, SeenSurface(input.scan, unit.scan.points), assessment, context, result);
  result.converged = result.inlier_ratio >= assessment.min_inlier_ratio;
  return result;
}

}  // namespace orbifit

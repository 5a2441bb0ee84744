#include "resolution/simplest_fit.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "assessment/fit_assessment.h"
#include "fit_systems.h"
#include "fit_trial.h"
#include "resolution/fit_residuals.h"
#include "solver/fit_system.h"
#include "start/other_scale.h"

namespace orbifit {

namespace {

// A sensor's errors that neighbours share, squared, by width: the octaves between a stiff and a soft fit have about as
// much as those that a soft one leaves, by measure half of it or less.
constexpr double kAlike = 0.5;
constexpr double kMostlyShared = 0.5;  // of what is left: less is the rest of a shape beside noise of another kind
// Times the noise among neighbours: more than that is no sensor's error but shape, which the template cannot take on.
// Measured of a depth camera 1.6 to 2.7.
constexpr double kMostShared = 3;
constexpr double kStiffer = 10;  // times, a step
constexpr int kMostSteps = 3;  // from a tenth, as noisy scans ask for, to a hundred: then the template is all but rigid

double mean_squared(const FitResiduals& residuals) {
  return std::accumulate(residuals.squared.begin(), residuals.squared.end(), 0.0) /
         static_cast<double>(residuals.squared.size());
}

// What a fit leaves of the scan, mean squared, and how much more one may leave that explains it alike.
struct Left {
  double squared = 0, allowance = 0;
  double most() const { return squared + allowance; }
};

Left left_by(const FitInput& input, const PlacedScan& start, const FitResult& result, const RunContext& context) {
  const FitResiduals left = fit_residuals(input, start, result, context);
  if (left.shared < kMostlyShared) return {mean_squared(left)};
  const double noise = kMostShared * start.scan.noise / (result.pose.scale * diagonal(input.mesh.vertices));
  return {mean_squared(left), kAlike * std::clamp(left.shared_squared, 0.0, noise * noise)};
}

bool may_be_simpler(const FitInput& input, const FitResult& result) {
  return result.subspace.mode() != GroupMode::moving && input.handles.empty();
}

// Fits of one subspace, each from another.
class Trials {
 public:
  /// References are kept. \param most  that a fit may leave, as Left says
  Trials(const FitInput& input, const PlacedScan& start, const FitOptions& options, const RunContext& context,
         const FitResult& first, double most)
      : input_(input),
        start_(start),
        options_(options),
        context_(context),
        system_(first.subspace, input.mesh, options.stretch,
                contacts_to_keep(start, first.subspace, input.mesh, options, context)),
        most_(most) {}

  // Replaces the fit by one from the state, if that explains the scan alike. \return whether it does
  bool replace(FitState state, double stiffness, bool scale_open, FitResult& fit) {
    FitOptions options = options_;
    options.least_stiffness = stiffness;
    PlacedScan start = start_;
    start.scale_open = scale_open;
    FitResult found = fit_from(std::move(state), options.levels, input_, start, system_, options, context_);
    if (explains_scan(found, !fit.placements.empty(), options_) && alike(found)) {
      take_over(std::move(found), fit);
      return true;
    }
    fit.iterations_in_all += found.iterations_in_all;
    return false;
  }

 private:
  bool alike(const FitResult& found) const {
    return mean_squared(fit_residuals(input_, start_, found, context_)) <= most_;
  }

  const FitInput& input_;
  const PlacedScan& start_;
  const FitOptions& options_;
  const RunContext& context_;
  FitSystem system_;
  double most_;
};

}  // namespace

void keep_own_size(const FitInput& input, const PlacedScan& start, const FitOptions& options, const RunContext& context,
                   FitResult& result) {
  const double scale = input.pose.scale;
  if (options.fixed_scale || result.pose.scale == scale || !of_one_kind(result.pose.scale, scale)) return;
  if (!may_be_simpler(input, result)) return;
  FitState state = with_scale(scale, result.pose, {result.q, result.basis}, result.subspace, input.mesh);
  state.others = result.others;
  Trials trials(input, start, options, context, result, left_by(input, start, result, context).most());
  trials.replace(std::move(state), result.iterations.back().stiffness, false, result);
}

bool keep_stiffest(const FitInput& input, const PlacedScan& start, const FitOptions& options, const RunContext& context,
                   FitResult& result) {
  if (!may_be_simpler(input, result)) return false;
  const Left left = left_by(input, start, result, context);
  if (left.allowance == 0) return false;
  Trials trials(input, start, options, context, result, left.most());
  const bool scale_open = start.scale_open && result.pose.scale != input.pose.scale;
  const double stiffness = result.iterations.back().stiffness;
  int steps = 0;
  while (steps < kMostSteps) {
    FitState state{result.pose, result.q, result.others};
    if (!trials.replace(std::move(state), stiffness * std::pow(kStiffer, steps + 1), scale_open, result)) break;
    ++steps;
  }
  return steps > 0;
}

}  // namespace orbifit

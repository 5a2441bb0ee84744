#include "resolution/refinement.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "basis/subspace_parts.h"
#include "fit_systems.h"
#include "fit_trial.h"
#include "resolution/fit_residuals.h"
#include "solver/fit_system.h"

namespace orbifit {

namespace {

constexpr double kFiner = 3;          // times the degrees of freedom, a level
constexpr std::size_t kEvery = 10;    // so manieth point of the scan is held out
constexpr double kSure = 2;           // standard errors of what held-out points gain
constexpr double kWorthwhile = 0.05;  // of the squared residuals: what a finer fit could gain at most

std::vector<double> held_out(const std::vector<double>& of_points, const std::vector<char>& chosen) {
  std::vector<double> result;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    if (chosen[i] != 0) result.push_back(of_points[i]);
  }
  return result;
}

double root_mean(const std::vector<double>& squares) {
  return std::sqrt(std::accumulate(squares.begin(), squares.end(), 0.0) / static_cast<double>(squares.size()));
}

// Whether the second of two paired samples is smaller in the mean, by more than chance.
bool smaller(const std::vector<double>& before, const std::vector<double>& after) {
  const auto count = static_cast<double>(before.size());
  double sum = 0, squares = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const double gain = before[i] - after[i];
    sum += gain;
    squares += gain * gain;
  }
  const double mean = sum / count;
  return mean > kSure * std::sqrt(std::max(0.0, squares / count - mean * mean) / count);
}

// From where a coarser fit ended.
FitResult finer_fit(const FitInput& input, const PlacedScan& start, const FitOptions& options,
                    const RunContext& context, const FitResult& coarse) {
  SubspaceOptions finer = options.subspace;
  finer.samples = 0;
  finer.radius = coarse.subspace.radius() / std::sqrt(kFiner);
  const Subspace subspace = build_subspace(input.mesh, input.annotation, finer, context);
  Eigen::VectorXd q = transferred(coarse.subspace, {coarse.q, coarse.basis}, subspace, context);
  FitSystem system(subspace, input.mesh, options.stretch, contacts_to_keep(subspace, input.mesh, options, context),
                   sample_displacements(subspace, q));
  return fit_from({coarse.pose, std::move(q), coarse.others}, options.levels, input, start, system, options, context);
}

}  // namespace

namespace {

void refine_from_start(const FitInput& input, const PlacedScan& start, const FitOptions& options,
                       const RunContext& context, FitResult& result) {
  PlacedScan most = start;
  most.held_out.assign(static_cast<std::size_t>(start.scan.points.rows()), 0);
  for (std::size_t i = kEvery / 2; i < most.held_out.size(); i += kEvery) most.held_out[i] = 1;
  if (std::ranges::count(most.held_out, 1) == 0) return;
  FitResiduals now = fit_residuals(input, start, result, context);
  std::vector<double> before = held_out(now.squared, most.held_out);
  result.levels = {{result.samples, result.degrees_of_freedom, root_mean(before), true}};
  // Groups that turn are left as coarse as they are.
  if (result.subspace.mode() == GroupMode::moving) return;
  for (int level = 0; level < options.refinements && now.shared > kWorthwhile; ++level) {
    FitResult found = finer_fit(input, most, options, context, result);
    now = fit_residuals(input, start, found, context);
    std::vector<double> after = held_out(now.squared, most.held_out);
    const bool better = smaller(before, after);
    result.levels.push_back({found.samples, found.degrees_of_freedom, root_mean(after), better});
    result.iterations_in_all += found.iterations_in_all;
    if (!better) return;
    found.levels = std::move(result.levels);
    found.iterations_in_all = result.iterations_in_all;
    found.placements = std::move(result.placements);
    found.groups = std::move(result.groups);
    found.dropped = std::move(result.dropped);
    found.other_used = std::move(result.other_used);
    found.landmarks = std::move(result.landmarks);
    result = std::move(found);
    before = std::move(after);
  }
}

}  // namespace

void refine(const FitInput& input, const PlacedScan& start, const FitOptions& options, const RunContext& context,
            FitResult& result) {
  // The other scans' motions are told from their own frames; while fitting, from where the start has put them.
  for (std::size_t k = 0; k < start.others.size(); ++k) result.others[k] = result.others[k] * inverse(start.others[k]);
  refine_from_start(input, start, options, context, result);
  for (std::size_t k = 0; k < start.others.size(); ++k) result.others[k] = result.others[k] * start.others[k];
}

}  // namespace orbifit

#include "refinement.h"

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "orbifit/model/errors.h"

#include "basis/subspace_parts.h"
#include "domains/piece_moments.h"
#include "fit_systems.h"
#include "fit_trial.h"
#include "resolution/detail.h"
#include "resolution/fit_residuals.h"
#include "resolution/held_out.h"
#include "resolution/simplest_fit.h"
#include "resolution/transfer.h"
#include "solver/fit_system.h"

namespace orbifit {

namespace {

constexpr double kFiner = 3;        // times the degrees of freedom, a level
constexpr int kMaxSamples = 10000;  // of which three times as many are taken

double finer_radius(const FitResult& coarse) {
  return coarse.subspace.radius() / std::sqrt(kFiner);
}

// From where a coarser fit ended; none where no subspace is so fine.
std::optional<FitResult> finer_fit(const FitInput& input, const PlacedScan& start, const FitOptions& options,
                                   const RunContext& context, const FitResult& coarse) {
  SubspaceOptions finer = options.subspace;
  finer.samples = 0;
  finer.radius = finer_radius(coarse);
  std::optional<Subspace> built;
  try {
    const bool own = start.shared && start.shared->owns(coarse.subspace);
    built = own ? rebuilt_subspace(coarse.subspace, input.mesh, input.annotation, finer, context)
                : build_subspace(input.mesh, input.annotation, finer, context);
  } catch (const InputError&) {
    return std::nullopt;  // more samples than it may have: how many, its groups say
  }
  const Subspace& subspace = *built;
  Eigen::VectorXd q = transferred(coarse.subspace, {coarse.q, coarse.basis}, subspace, context);
  FitSystem system(subspace, input.mesh, options.stretch,
                   contacts_to_keep(start, subspace, input.mesh, options, context), sample_displacements(subspace, q));
  return fit_from({coarse.pose, std::move(q), coarse.others}, options.levels, input, start, system, options, context);
}

void refine_from_start(const FitInput& input, const PlacedScan& start, const FitOptions& options,
                       const RunContext& context, FitResult& result) {
  FitResiduals now = fit_residuals(input, start, result, context);
  // Groups that turn are left as coarse as they are.
  if (result.subspace.mode() == GroupMode::moving) return;
  PlacedScan most = start;
  for (int level = 0; level < options.refinements && now.shared > kWorthRefining && result.samples <= kMaxSamples;
       ++level) {
    const double width = finer_radius(result) * result.pose.scale;
    most.held_out = some_patches(start.scan.points, width, context.seed);
    const std::vector<double> before = of_chosen(now.squared, most.held_out);
    if (before.empty()) return;
    std::optional<FitResult> finer = finer_fit(input, most, options, context, result);
    if (!finer) return;
    FitResult found = std::move(*finer);
    now = fit_residuals(input, start, found, context);
    const std::vector<double> after = of_chosen(now.squared, most.held_out);
    const bool better = smaller(before, after);
    result.levels.push_back({found.samples, found.degrees_of_freedom, root_mean(before), root_mean(after), better});
    if (!better) {
      result.iterations_in_all += found.iterations_in_all;
      return;
    }
    take_over(std::move(found), result);
  }
}

// Root mean square distance of a surface from its centre.
double spread(const Mesh& mesh) {
  const std::vector<int> one_set(static_cast<std::size_t>(mesh.faces.rows()), 0);
  const Eigen::Vector3d origin = mesh.vertices.colwise().mean();
  const PieceMoments moments = moments_of_sets(mesh, one_set, 1, origin).front();
  const Eigen::Vector3d centre = moments.first / moments.area;
  return std::sqrt(moments.second.trace() / moments.area - centre.squaredNorm());
}

}  // namespace

void refine(const FitInput& input, const PlacedScan& start, const FitOptions& options, const RunContext& context,
            FitResult& result) {
  // The other scans' motions are told from their own frames; while fitting, from where the start has put them.
  for (std::size_t k = 0; k < start.others.size(); ++k) result.others[k] = result.others[k] * inverse(start.others[k]);
  keep_own_size(input, start, options, context, result);
  if (options.subspace.radius == 0 && options.subspace.samples == 0) {
    const bool stiffer = keep_stiffest(input, start, options, context, result);
    result.levels = {{result.samples, result.degrees_of_freedom, 0, 0, true}};
    if (!stiffer) refine_from_start(input, start, options, context, result);
  }
#ifndef ORBIFIT_PORTABLE
  if (options.detail) add_detail(input, start, options, context, result);
#endif
  result.growth = spread(result.fitted) / (result.pose.scale * spread(input.mesh)) - 1;
  result.own_size = options.place && !options.fixed_scale && result.pose.scale == input.pose.scale;
  for (std::size_t k = 0; k < start.others.size(); ++k) result.others[k] = result.others[k] * start.others[k];
}

}  // namespace orbifit

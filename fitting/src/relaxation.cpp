#include "relaxation.h"

#include <string>
#include <utility>
#include <vector>

#include "orbifit/model/consistent_annotation.h"
#include "orbifit/subspace/displacement_field.h"
#include "orbifit/subspace/subspace.h"

#include "assessment/group_comparison.h"
#include "fit_systems.h"
#include "fit_trial.h"
#include "solver/fit_system.h"

namespace orbifit {

namespace {

// The template fitted without any group, finely enough that parts may move by themselves.
Mesh free_fit(const FitInput& input, const PlacedScan& start, const FitOptions& options, const RunContext& context) {
  constexpr int kFewSamples = 150;
  const SymmetryAnnotation none = empty_annotation(input.mesh, input.annotation.tolerance);
  FitOptions free = options;
  free.subspace = SubspaceOptions{};
  free.subspace.samples = kFewSamples;
  const FitInput without = input.with(none);
  const Subspace subspace = build_subspace(input.mesh, none, free.subspace, context);
  FitSystem system(subspace, input.mesh, free.stretch, contacts_to_keep(start, subspace, input.mesh, free, context));
  return fit_from(without, start, system, free, context).fitted;
}

// The fit without these regions: what the whole of a fit has found, such as placements, stays.
void leave_out(const std::vector<GroupAgreement>& groups, const FitInput& input, const PlacedScan& start,
               const FitOptions& options, const RunContext& context, FitResult& result) {
  for (const GroupAgreement& group : groups) {
    result.dropped.push_back(group.region);
    context.message("left out region " + std::to_string(group.region) + ": the scan has not its symmetry");
  }
  const SymmetryAnnotation rest =
      made_consistent(input.mesh, without_regions(input.annotation, result.dropped), context);
  const Subspace subspace = build_subspace(input.mesh, rest, options.subspace, context);
  FitSystem system(subspace, input.mesh, options.stretch,
                   contacts_to_keep(start, subspace, input.mesh, options, context));
  FitResult found = fit_from(input.with(rest), start, system, options, context);
  for (std::size_t k = 0; k < found.others.size(); ++k) found.others[k] = found.others[k] * start.others[k];
  take_over(std::move(found), result);
}

}  // namespace

std::vector<GroupAgreement> judged_groups(const Mesh& fitted, const SymmetryAnnotation& annotation,
                                          const FitInput& input, const PlacedScan& start, const FitOptions& options,
                                          const RunContext& context) {
  return group_agreement(fitted, free_fit(input, start, options, context), annotation, start.scan, context);
}

void drop_unsupported(const FitInput& input, const PlacedScan& start, const FitOptions& options,
                      const RunContext& context, FitResult& result) {
  constexpr int kMaxRelaxations = 5;
  if (auto told = agreement_beyond_doubt(result.fitted, result.annotation, start.scan, context)) {
    result.groups = *std::move(told);
    return;
  }
  const Mesh free = free_fit(input, start, options, context);
  for (int round = 0;; ++round) {
    std::vector<GroupAgreement> groups = group_agreement(result.fitted, free, result.annotation, start.scan, context);
    if (round == 0) result.groups = groups;
    std::erase_if(groups, [](const GroupAgreement& group) { return !group.disagrees; });
    if (groups.empty() || round == kMaxRelaxations) return;
    leave_out(groups, input, start, options, context, result);
  }
}

}  // namespace orbifit

#include "comparison.h"

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <string_view>

#include "orbifit/baselines/full_sampling.h"
#include "orbifit/baselines/handle_edit.h"
#include "orbifit/baselines/kurz.h"
#include "orbifit/baselines/similarity_fit.h"
#include "orbifit/baselines/svd_nullspace.h"
#include "orbifit/datasets_tools/symmetry_residual.h"
#include "orbifit/model/errors.h"

#include "divided.h"

namespace orbifit {

namespace {

using Run = std::function<FitResult(const FitInput&, const FitOptions&, double weight, const RunContext&)>;

FitResult run_ours(const FitInput& input, const FitOptions& options, double, const RunContext& context) {
  return input.scan.points.rows() == 0 ? edit_by_handles(input, options, context) : fit(input, options, context);
}

FitResult run_kurz(const FitInput& input, const FitOptions& options, double weight, const RunContext& context) {
  KurzOptions kurz;
  kurz.symmetry_weight = weight;
  kurz.scan_points = options.scan_points;
  kurz.inlier_distance = options.inlier_distance;
  kurz.align = options.align;
  kurz.condition = options.condition;
  kurz.linear_iterations = std::min(kurz.linear_iterations, options.max_iterations);
  return fit_kurz(input, kurz, context);
}

Run on_full_sampling(FullSymmetry symmetry) {
  return [symmetry](const FitInput& input, const FitOptions& options, double weight, const RunContext& context) {
    FullSamplingOptions chosen;
    chosen.fit = options;
    chosen.symmetry = symmetry;
    if (weight > 0) chosen.weight = weight;
    return fit_full_sampling(input, chosen, context);
  };
}

FitResult run_svd(const FitInput& input, const FitOptions& options, double, const RunContext& context) {
  SvdNullspaceOptions chosen;
  chosen.fit = options;
  return fit_svd_nullspace(input, chosen, context);
}

FitResult run_similarity(const FitInput& input, const FitOptions& options, double, const RunContext& context) {
  SimilarityOptions chosen;
  chosen.fit = options;
  return fit_similarity(input, chosen, context);
}

const Run& run_of(const std::string& name) {
  static const std::map<std::string, Run> runs{{"ours", run_ours},
                                               {"kurz", run_kurz},
                                               {"soft", on_full_sampling(FullSymmetry::soft)},
                                               {"full-constrained", on_full_sampling(FullSymmetry::constrained)},
                                               {"svd-nullspace", run_svd},
                                               {"none", on_full_sampling(FullSymmetry::none)},
                                               {"similarity", run_similarity}};
  return runs.at(name);
}

// Stages before the iterations.
constexpr std::array<std::string_view, 4> kBefore{"scan", "alignment", "subspace", "prepare"};

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

std::vector<Method> asked(const std::vector<std::string>& names) {
  std::vector<Method> result;
  for (const Method& method : methods()) {
    if (names.empty() || std::ranges::find(names, method.name) != names.end()) result.push_back(method);
  }
  return result;
}

// Those whose iterations depend on the samples; of the dense ones, no more than they can do in a minute.
bool times_samples(const Method& method, int samples) {
  constexpr int kMaxOfSvd = 600;
  if (method.name == "kurz" || method.name == "similarity") return false;
  return method.name != "svd-nullspace" || samples <= kMaxOfSvd;
}

void time_samples(const Method& method, const FitInput& input, const ComparisonOptions& options, RunContext& context,
                  Comparison& result) {
  for (const int samples : options.samples) {
    if (!times_samples(method, samples)) continue;
    FitOptions chosen = with_few_iterations(options.fit);
    chosen.subspace.radius = 0;
    chosen.subspace.samples = samples;
    result.samples.push_back(run_method(method, method.weight, input, chosen, nullptr, context));
  }
}

void time_meshes(const std::vector<Method>& chosen, const FitInput& input, const ComparisonOptions& options,
                 RunContext& context, Comparison& result) {
  constexpr Eigen::Index kMaxFaces = 400000;
  AnnotatedMesh finer{input.mesh, input.annotation};
  for (int round = 0; round < options.meshes; ++round) {
    if (round > 0) {
      if (4 * finer.mesh.faces.rows() > kMaxFaces) break;
      finer = divided(finer.mesh, finer.annotation);
    }
    const FitInput other{finer.mesh, finer.annotation, input.scan, input.pose, input.landmarks, input.handles};
    for (const Method& method : chosen) {
      if (method.name == "similarity") continue;
      result.meshes.push_back(
          run_method(method, method.weight, other, with_few_iterations(options.fit), nullptr, context));
    }
  }
  std::ranges::stable_sort(result.meshes, {}, [](const MethodRun& run) {
    return std::ranges::find(methods(), run.method, &Method::name) - methods().begin();
  });
}

}  // namespace

const std::vector<Method>& methods() {
  static const std::vector<Method> all{
      {"ours", "exact symmetric subspace", 0},
      {"kurz", "grid deformation, symmetry by least squares (Kurz et al. 2014)", 3},
      {"soft", "all samples free, symmetry as a penalty", 100},
      {"full-constrained", "all samples, symmetry by Lagrange multipliers", 0},
      {"svd-nullspace", "null space of the constraints by SVD (Bokeloh et al. 2012)", 0},
      {"none", "all samples free, no symmetry", 0},
      {"similarity", "rigid motion and scale", 0},
  };
  return all;
}

void ComparisonOptions::validate() const {
  for (const std::string& name : methods) {
    if (std::ranges::find(orbifit::methods(), name, &Method::name) == orbifit::methods().end()) {
      std::string names;
      for (const Method& method : orbifit::methods()) names += (names.empty() ? "" : ", ") + std::string(method.name);
      throw UsageError("methods has '" + name + "'; there are " + names);
    }
  }
  for (const double weight : weights) {
    if (!(weight > 0)) throw UsageError("weights has " + std::to_string(weight) + "; each must be positive");
  }
  for (const int count : samples) {
    if (count < 4) throw UsageError("samples has " + std::to_string(count) + "; each must be at least 4");
  }
  fit.validate();
}

FitOptions with_few_iterations(FitOptions options) {
  constexpr int kIterations = 3;
  options.levels = 2;
  options.iterations = kIterations;
  options.max_iterations = 2 * kIterations;
  options.condition = false;
  return options;
}

MethodRun run_method(const Method& method, double weight, const FitInput& input, const FitOptions& options,
                     const ComparisonTruth* truth, RunContext& context) {
  MethodRun run;
  run.method = method.name;
  run.weight = weight;
  run.faces = static_cast<int>(input.mesh.faces.rows());
  run.scanned = input.scan.points.rows() > 0;
  try {
    run.result = run_of(method.name)(input, options, weight, context);
  } catch (const InterruptedError&) {
    throw;
  } catch (const Error& error) {
    run.failure = error.what();
    return run;
  }
  std::vector<double> seconds;
  for (const FitIteration& iteration : run.result.iterations) seconds.push_back(iteration.seconds);
  run.iteration = median(seconds);
  for (const StageTime& time : run.result.times) {
    if (std::ranges::find(kBefore, time.stage) != std::end(kBefore)) run.prepare += time.seconds;
  }
  const SymmetryReport symmetry =
      symmetry_residual(input.mesh, input.annotation, &run.result.fitted, CarriedMotions::moving, context);
  run.symmetry = symmetry.worst_excess;
  run.vertex_excess = symmetry.vertex_excess;
  run.bending = bending(input.mesh, run.result.fitted);
  for (const RegionResidual& region : symmetry.regions) {
    if (region.excess.max == symmetry.worst_excess) run.worst_region = region.name;
  }
  if (truth != nullptr) {
    run.score = score_fit(input.mesh, input.annotation, truth->mesh, truth->visible, run.result.fitted, context);
  }
  return run;
}

Comparison compare(const FitInput& input, const ComparisonOptions& options, const ComparisonTruth* truth,
                   RunContext& context) {
  options.validate();
  const std::vector<Method> chosen = asked(options.methods);
  FitOptions same = options.fit;
  same.place = same.align = false;
  same.condition = true;
  Comparison result;
  for (const Method& method : chosen) {
    context.progress(method.name, 0);
    result.runs.push_back(run_method(method, method.weight, input, same, truth, context));
    if (method.weight == 0) continue;
    for (const double weight : options.weights) {
      result.weights.push_back(run_method(method, weight, input, same, truth, context));
    }
  }
  ComparisonOptions timed = options;
  timed.fit = same;
  for (const Method& method : chosen) time_samples(method, input, timed, context, result);
  time_meshes(chosen, input, timed, context, result);
  return result;
}

}  // namespace orbifit

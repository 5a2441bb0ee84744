#include "subspace_arguments.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include <CLI/CLI.hpp>

#include "orbifit/model/consistent_annotation.h"
#include "orbifit/model/errors.h"
#include "orbifit/subspace/radius_field.h"

#include "command.h"

namespace orbifit {

namespace {

const std::map<std::string, GroupMode> kModes{
    {"fixed", GroupMode::fixed}, {"floating", GroupMode::floating}, {"moving", GroupMode::moving}};
const std::map<std::string, LiftKind> kLifts{{"orbit", LiftKind::orbit}, {"paper", LiftKind::paper}};
constexpr std::array kNames{"--mode", "--lift", "--radius", "--samples", "--radius-field", "--sharp-features"};

}  // namespace

void add_mode_option(CLI::App& app, GroupMode& mode) {
  app.add_option(
         "--mode", mode,
         "How the regions' groups may move with the shape: fixed (not at all), floating (each by a translation) or "
         "moving (each by a rigid motion)")
      ->transform(CLI::CheckedTransformer(kModes).description(""))
      ->type_name("MODE")
      ->default_str("floating");
}

void add_subspace_options(CLI::App& app, SubspaceArguments& arguments) {
  SubspaceOptions& options = arguments.options;
  add_mode_option(app, options.mode);
  app.add_option(
         "--lift", options.lift,
         "How the vertices follow the samples: orbit (exact in every region) or paper (not exact in partial regions)")
      ->transform(CLI::CheckedTransformer(kLifts).description(""))
      ->type_name("LIFT")
      ->default_str("orbit");
  auto* radius = app.add_option("--radius", options.radius,
                                "Sampling radius, mesh units; a smaller one allows finer edits with more unknowns");
  app.add_option("--samples", options.samples, "Approximate number of samples, instead of a radius")->excludes(radius);
  app.add_flag("--sharp-features", options.sharp_features_first, "Place samples on sharp edges and corners first");
  app.add_option("--radius-field", arguments.radius_field, "Radius field (.json): where sampling is finer or coarser")
      ->type_name("FILE");
}

void exclude_subspace_options(CLI::App& app, CLI::Option& option) {
  for (const char* name : kNames) option.excludes(app.get_option(name));
}

void add_without_option(CLI::App& app, std::vector<int>& ids) {
  app.add_option("--without", ids, "Ids of regions whose groups are not kept")->delimiter(',')->type_name("ID,...");
}

SymmetryAnnotation without(const std::vector<int>& ids, SymmetryAnnotation annotation) {
  if (ids.empty()) return annotation;
  for (const int id : ids) require_region("--without", id, annotation);
  return without_regions(std::move(annotation), ids);
}

SubspaceOptions subspace_options(const SubspaceArguments& arguments, const Mesh& mesh, const RunContext& context) {
  SubspaceOptions options = arguments.options;
  options.validate();
  if (arguments.radius_field.empty()) return options;
  options.relative_radii = relative_radii(mesh, arguments.radius_field, options, context);
  return options;
}

Subspace build_consistent(const Mesh& mesh, SymmetryAnnotation& annotation, const SubspaceOptions& options,
                          const RunContext& context) {
  annotation = made_consistent(mesh, annotation, context);
  return build_subspace(mesh, annotation, options, context);
}

}  // namespace orbifit

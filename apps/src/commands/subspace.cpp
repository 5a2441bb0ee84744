#include "orbifit/subspace/subspace.h"

#include <chrono>
#include <filesystem>
#include <memory>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "orbifit/model/annotation_io.h"
#include "orbifit/model/mesh_io.h"
#include "orbifit/subspace/displacement_field.h"
#include "orbifit/subspace/subspace_io.h"

#include "../commands.h"
#include "../residual_json.h"
#include "../subspace_arguments.h"
#include "base/random.h"
#include "basis/subspace_parts.h"

namespace orbifit::commands {

namespace {

struct Arguments {
  std::string mesh, annotation, output;
  std::vector<int> without;
  SubspaceArguments subspace;
  bool compare_lifts = false;
};

/// How exactly each region is kept by one lift.
struct LiftResiduals {
  LiftKind lift;
  std::vector<Residual> regions;
};

// How exactly a random displacement of the basis keeps each region: the field against its images in space.
LiftResiduals random_field_residuals(const Mesh& mesh, const SymmetryAnnotation& annotation, const Subspace& subspace,
                                     const RunContext& run) {
  Random random(run.seed, "field residual");
  Eigen::VectorXd q(subspace.degrees_of_freedom());
  const double size = 0.05 * subspace.diagonal();
  for (double& coordinate : q) coordinate = size * random.normal();
  return {subspace.lift_kind(), field_residuals(subspace, mesh, annotation, {q, nullptr}, run)};
}

// The same samples and coordinates under the lift that was not chosen.
LiftResiduals residuals_of_other_lift(const Mesh& mesh, const SymmetryAnnotation& annotation, const Subspace& built,
                                      SubspaceOptions options, const RunContext& run) {
  options.lift = built.lift_kind() == LiftKind::orbit ? LiftKind::paper : LiftKind::orbit;
  options.radius = built.radius();
  options.samples = 0;
  RunContext silent = run;
  silent.on_message = nullptr;
  return random_field_residuals(mesh, annotation, build_subspace(mesh, annotation, options, silent), silent);
}

nlohmann::ordered_json to_json(const SymmetryAnnotation& annotation, const std::vector<LiftResiduals>& residuals) {
  nlohmann::ordered_json regions = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < annotation.regions.size(); ++i) {
    const Region& region = annotation.regions[i];
    nlohmann::ordered_json by_lift;
    for (const LiftResiduals& one : residuals) by_lift[to_string(one.lift)] = to_json(one.regions[i]);
    regions.push_back({{"id", region.id},
                       {"name", region.name},
                       {"group", region.group.symbol()},
                       {"field_residual", to_json(residuals.front().regions[i])},
                       {"residual_of_lift", by_lift}});
  }
  return regions;
}

std::string to_table(const SymmetryAnnotation& annotation, const std::vector<LiftResiduals>& residuals) {
  std::vector<std::string> header{"region", "group"};
  for (const LiftResiduals& one : residuals) header.push_back(to_string(one.lift) + " lift %");
  header.emplace_back("name");
  TextTable table(header);
  for (std::size_t i = 0; i < annotation.regions.size(); ++i) {
    const Region& region = annotation.regions[i];
    std::vector<std::string> row{std::to_string(region.id), region.group.symbol()};
    for (const LiftResiduals& one : residuals) row.push_back(short_number(100 * one.regions[i].max, 3));
    row.push_back(region.name);
    table.add(row);
  }
  return table.text() +
         "Residuals are of a random displacement, at the images of each region's vertices, in percent of the "
         "diagonal.\n";
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

CommandBody subspace(CLI::App& app) {
  const auto arguments = std::make_shared<Arguments>();
  app.add_option("MESH", arguments->mesh, "Mesh to build the subspace of")->required();
  app.add_option("ANNOTATION", arguments->annotation, "Its annotation (.json)")->required();
  app.add_option("-o,--output", arguments->output, "Basis to write, for 'orbifit deform --basis'")->type_name("FILE");
  add_without_option(app, arguments->without);
  add_subspace_options(app, arguments->subspace);
  app.add_flag("--compare-lifts", arguments->compare_lifts, "Report the residuals of the other lift too");
  return [arguments](CommandContext& context) {
    arguments->subspace.options.validate();
    const bool stores = !arguments->output.empty();
    if (stores) {
      check_output(arguments->output, {}, {arguments->mesh, arguments->annotation, arguments->subspace.radius_field});
    }
    const Mesh mesh = read_mesh(arguments->mesh);
    SymmetryAnnotation annotation = without(arguments->without, read_annotation(arguments->annotation, mesh));
    const SubspaceOptions options = subspace_options(arguments->subspace, mesh, context.run);
    const auto start = std::chrono::steady_clock::now();
    const Subspace built = build_consistent(mesh, annotation, options, context.run);
    const double seconds = seconds_since(start);
    std::vector<LiftResiduals> residuals{random_field_residuals(mesh, annotation, built, context.run)};
    if (arguments->compare_lifts) {
      residuals.push_back(residuals_of_other_lift(mesh, annotation, built, options, context.run));
    }
    context.run.check();
    if (stores) write_subspace(arguments->output, built, mesh, annotation);
    const double neighbours = static_cast<double>(built->lift.used) / std::max(1, built->orbits.representatives());
    if (context.json) {
      nlohmann::ordered_json summary{{"mode", to_string(built.mode())},
                                     {"lift", to_string(built.lift_kind())},
                                     {"radius", built.radius()},
                                     {"samples", built.samples().rows()},
                                     {"orbits", built->sampling.orbits()},
                                     {"degrees_of_freedom", built.degrees_of_freedom()},
                                     {"samples_per_vertex", neighbours},
                                     {"build_seconds", seconds},
                                     {"regions", to_json(annotation, residuals)}};
      if (stores) summary["basis"] = arguments->output;
      print(context, summary.dump(2) + "\n");
      return kDone;
    }
    std::string text = "mode                " + to_string(built.mode()) + "\n";
    text += "lift                " + to_string(built.lift_kind()) + "\n";
    text += "radius              " + short_number(built.radius()) + " (" +
            short_number(100 * built.radius() / diagonal(mesh.vertices), 3) + " % of the diagonal)\n";
    text += "samples             " + std::to_string(built.samples().rows()) + " in " +
            count_of(built->sampling.orbits(), "orbit") + "\n";
    text += "degrees of freedom  " + std::to_string(built.degrees_of_freedom()) + "\n";
    text += "samples per vertex  " + short_number(neighbours, 3) + "\n";
    text += "time                " + short_number(seconds, 3) + " s\n";
    if (stores) text += "basis               " + arguments->output + "\n";
    if (!annotation.regions.empty()) text += to_table(annotation, residuals);
    print(context, text);
    return kDone;
  };
}

}  // namespace orbifit::commands

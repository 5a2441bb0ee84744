#include "orbifit/subspace/subspace.h"

#include <chrono>
#include <memory>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "orbifit/model/annotation_io.h"
#include "orbifit/model/mesh_io.h"
#include "orbifit/model/random.h"
#include "orbifit/subspace/displacement_field.h"

#include "../commands.h"
#include "../subspace_arguments.h"

namespace orbifit::commands {

namespace {

struct SubspaceArguments {
  std::string mesh, annotation;
  SubspaceOptions options;
};

// How exactly a random displacement of the basis keeps each region: the field against its images in space.
std::vector<Residual> random_field_residuals(const Mesh& mesh, const SymmetryAnnotation& annotation,
                                             const Subspace& subspace, const RunContext& run) {
  Random random(run.seed, "field residual");
  Eigen::VectorXd q(subspace.degrees_of_freedom());
  for (double& coordinate : q) coordinate = 0.05 * diagonal(mesh.vertices) * random.normal();
  std::vector<Residual> residuals;
  for (std::size_t i = 0; i < annotation.regions.size(); ++i) {
    run.progress("residuals", static_cast<double>(i) / static_cast<double>(annotation.regions.size()));
    residuals.push_back(field_residual(subspace, mesh, annotation.regions[i], static_cast<int>(i), q, run));
  }
  return residuals;
}

}  // namespace

CommandBody subspace(CLI::App& app) {
  const auto arguments = std::make_shared<SubspaceArguments>();
  app.add_option("MESH", arguments->mesh, "Mesh")->required();
  app.add_option("ANNOTATION", arguments->annotation, "Its annotation (.json)")->required();
  add_subspace_options(app, arguments->options);
  return [arguments](CommandContext& context) {
    arguments->options.validate();
    const Mesh mesh = read_mesh(arguments->mesh);
    const SymmetryAnnotation annotation = read_annotation(arguments->annotation, mesh);
    const auto start = std::chrono::steady_clock::now();
    const Subspace built = build_subspace(mesh, annotation, arguments->options, context.run);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const std::vector<Residual> residuals = random_field_residuals(mesh, annotation, built, context.run);
    const double neighbours = static_cast<double>(built.lift.used) / std::max(1, built.orbits.representatives());
    if (context.json) {
      nlohmann::ordered_json regions = nlohmann::ordered_json::array();
      for (std::size_t i = 0; i < residuals.size(); ++i) {
        const Region& region = annotation.regions[i];
        regions.push_back({{"id", region.id},
                           {"name", region.name},
                           {"group", region.group.symbol()},
                           {"field_residual", {{"rms", residuals[i].rms}, {"max", residuals[i].max}}}});
      }
      const nlohmann::ordered_json summary{{"mode", to_string(built.mode)},
                                           {"radius", built.sampling.radius},
                                           {"samples", built.sampling.points.rows()},
                                           {"orbits", built.sampling.orbits()},
                                           {"degrees_of_freedom", built.degrees_of_freedom()},
                                           {"samples_per_vertex", neighbours},
                                           {"build_seconds", seconds},
                                           {"regions", regions}};
      print(summary.dump(2) + "\n");
      return kDone;
    }
    std::string text = "mode                " + to_string(built.mode) + "\n";
    text += "radius              " + short_number(built.sampling.radius) + " (" +
            short_number(100 * built.sampling.radius / diagonal(mesh.vertices), 3) + " % of the diagonal)\n";
    text += "samples             " + std::to_string(built.sampling.points.rows()) + " in " +
            count_of(built.sampling.orbits(), "orbit") + "\n";
    text += "degrees of freedom  " + std::to_string(built.degrees_of_freedom()) + "\n";
    text += "samples a vertex    " + short_number(neighbours, 3) + "\n";
    text += "time                " + short_number(seconds, 3) + " s\n";
    if (!residuals.empty()) {
      TextTable table({"region", "group", "field residual", "name"});
      for (std::size_t i = 0; i < residuals.size(); ++i) {
        const Region& region = annotation.regions[i];
        table.add({std::to_string(region.id), region.group.symbol(), short_number(residuals[i].max, 3), region.name});
      }
      text += table.text() +
              "Residuals are of a random displacement, at the images of each region's vertices, as fractions of the "
              "diagonal.\n";
    }
    print(text);
    return kDone;
  };
}

}  // namespace orbifit::commands

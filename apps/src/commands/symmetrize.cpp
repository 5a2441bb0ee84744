#include "orbifit/subspace/symmetrize.h"

#include <memory>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "orbifit/datasets_tools/symmetry_residual.h"
#include "orbifit/model/annotation_io.h"
#include "orbifit/model/consistent_annotation.h"
#include "orbifit/model/errors.h"
#include "orbifit/model/mesh_io.h"

#include "../commands.h"
#include "../residual_json.h"
#include "../subspace_arguments.h"

namespace orbifit::commands {

namespace {

struct SymmetrizeArguments {
  std::string mesh, annotation, output, annotation_output;
  std::vector<int> without;
};

nlohmann::ordered_json to_json(const SymmetrizeReport& report, const SymmetryReport& after) {
  nlohmann::ordered_json regions = nlohmann::ordered_json::array();
  for (std::size_t r = 0; r < report.regions.size(); ++r) {
    const SymmetrizeReport::RegionChange& change = report.regions[r];
    regions.push_back({{"id", change.id},
                       {"name", change.name},
                       {"group", after.regions[r].group},
                       {"kept_as", change.group},
                       {"places", change.places},
                       {"mapped", change.mapped},
                       {"before", to_json(change.before)},
                       {"after", to_json(change.after)},
                       {"checked", to_json(after.regions[r].floor)}});
  }
  return {{"largest_movement", report.largest_movement},
          {"rms_movement", report.rms_movement},
          {"vertices_in_regions", report.in_regions},
          {"mapped", report.mapped},
          {"unclosed", report.unclosed},
          {"held", report.held},
          {"iterations", report.iterations},
          {"vertices_onto_vertices", after.vertices_onto_vertices},
          {"residual", after.worst_floor},
          {"regions", regions}};
}

std::string to_text(const std::string& output, const SymmetrizeReport& report, const SymmetryReport& after) {
  TextTable table(
      {"region", "group", "places", "mapped", "before rms %", "before max %", "after rms %", "after max %", "name"});
  for (std::size_t r = 0; r < report.regions.size(); ++r) {
    const SymmetrizeReport::RegionChange& change = report.regions[r];
    table.add({std::to_string(change.id), after.regions[r].group, std::to_string(change.places),
               std::to_string(change.mapped), short_number(100 * change.before.rms, 3),
               short_number(100 * change.before.max, 3), short_number(100 * change.after.rms, 3),
               short_number(100 * change.after.max, 3), change.name});
  }
  return output + ": vertices moved by " + percent(report.largest_movement) + " at most, " +
         percent(report.rms_movement) + " rms; " + std::to_string(report.mapped) + " of " +
         count_of(report.in_regions, "vertex", "vertices") + " in regions exactly symmetric" +
         (report.held > 0 ? ", " + std::to_string(report.held) + " left as they are, since a region would get worse"
                          : "") +
         (report.unclosed > 0 ? ", groups contradict one another at " + std::to_string(report.unclosed) : "") + "\n" +
         (report.regions.empty() ? "" : table.text()) + "Lengths are in percent of the diagonal.\n";
}

}  // namespace

CommandBody symmetrize(CLI::App& app) {
  const auto arguments = std::make_shared<SymmetrizeArguments>();
  app.add_option("MESH", arguments->mesh, "Mesh to make symmetric")->required()->type_name("FILE");
  app.add_option("ANNOTATION", arguments->annotation, "Its annotation (.json)")->required()->type_name("FILE");
  app.add_option("-o,--output", arguments->output, "Symmetric mesh to write")->required()->type_name("FILE");
  app.add_option("--annotation-out", arguments->annotation_output,
                 "Annotation of the symmetric mesh to write, with its residuals (.json)")
      ->type_name("FILE");
  add_without_option(app, arguments->without);
  return [arguments](CommandContext& context) {
    check_output(arguments->output, {}, {arguments->annotation});
    if (!arguments->annotation_output.empty()) {
      check_output(arguments->annotation_output, {".json"}, {arguments->mesh, arguments->output});
    }
    const Mesh mesh = read_mesh(arguments->mesh);
    SymmetryAnnotation annotation =
        made_consistent(mesh, without(arguments->without, read_annotation(arguments->annotation, mesh)), context.run);
    SymmetrizeReport report;
    const Mesh result = symmetrized(mesh, annotation, context.run, &report);
    const SymmetryReport after = symmetry_residual(result, annotation, nullptr, CarriedMotions::fixed, context.run);
    context.run.check();
    write_edited(arguments->output, arguments->mesh, result, context.run);
    if (!arguments->annotation_output.empty()) {
      annotation.mesh_diagonal = diagonal(result.vertices);
      for (std::size_t r = 0; r < annotation.regions.size(); ++r) {
        annotation.regions[r].residual = after.regions[r].floor;
      }
      for (std::size_t p = 0; p < annotation.patterns.size(); ++p) {
        annotation.patterns[p].residual = after.patterns[p].floor;
      }
      write_annotation(arguments->annotation_output, annotation);
    }
    print(context, context.json ? to_json(report, after).dump(2) + "\n" : to_text(arguments->output, report, after));
    return kDone;
  };
}

}  // namespace orbifit::commands

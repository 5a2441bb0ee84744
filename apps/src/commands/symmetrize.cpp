#include "orbifit/subspace/symmetrize.h"

#include <filesystem>
#include <memory>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "orbifit/datasets_tools/symmetry_residual.h"
#include "orbifit/model/annotation_io.h"
#include "orbifit/model/appearance.h"
#include "orbifit/model/consistent_annotation.h"
#include "orbifit/model/errors.h"
#include "orbifit/model/mesh_io.h"
#include "orbifit/subspace/symmetric_remesh.h"

#include "../commands.h"
#include "../residual_json.h"
#include "../subspace_arguments.h"
#include "files/file.h"

namespace orbifit::commands {

namespace {

struct SymmetrizeArguments {
  std::string mesh, annotation, output, annotation_output;
  std::vector<int> without;
  bool remesh = false;
  std::string report;
  SymmetricRemeshOptions options;
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

nlohmann::ordered_json to_json(const SymmetricRemesh& result, const SymmetryReport& after) {
  nlohmann::ordered_json regions = nlohmann::ordered_json::array();
  nlohmann::ordered_json patterns = nlohmann::ordered_json::array();
  for (const SymmetricRemeshItem& item : result.items) {
    nlohmann::ordered_json entry{{"id", item.id}, {"name", item.name}, {item.pattern ? "kind" : "group", item.group}};
    if (item.kept_as.empty()) {
      entry["left_out"] = item.reason;
    } else {
      entry["kept_as"] = item.kept_as;
      if (!item.pattern) entry["score"] = item.score;
    }
    (item.pattern ? patterns : regions).push_back(entry);
  }
  return {{"vertices", result.mesh.vertices.rows()},
          {"faces", result.mesh.faces.rows()},
          {"largest_movement", result.largest_distance},
          {"mean_movement", result.mean_distance},
          {"vertices_onto_vertices", after.vertices_onto_vertices},
          {"residual", after.worst_floor},
          {"regions", regions},
          {"patterns", patterns}};
}

std::string to_text(const std::string& output, const SymmetricRemesh& result, const SymmetryReport& after) {
  TextTable table({"", "group", "kept as", "score %", "name"});
  for (const SymmetricRemeshItem& item : result.items) {
    const bool kept = !item.kept_as.empty();
    table.add({(item.pattern ? "pattern " : "region ") + std::to_string(item.id), item.group,
               kept ? item.kept_as : "left out", kept && !item.pattern ? short_number(100 * item.score, 3) : "-",
               kept ? item.name : item.name + ": " + item.reason});
  }
  return output + ": " + count_of(result.mesh.vertices.rows(), "vertex", "vertices") + ", " +
         count_of(result.mesh.faces.rows(), "triangle") + "; the surface moved by " + percent(result.largest_distance) +
         " at most, " + percent(result.mean_distance) + " on average; vertices " +
         (after.vertices_onto_vertices ? "map onto vertices" : "do not all map onto vertices") + " to " +
         percent(after.worst_floor) + "\n" + (result.items.empty() ? "" : table.text()) +
         "Lengths are in percent of the diagonal.\n";
}

void set_residuals(SymmetryAnnotation& annotation, const SymmetryReport& report) {
  for (std::size_t r = 0; r < annotation.regions.size(); ++r) annotation.regions[r].residual = report.regions[r].floor;
  for (std::size_t p = 0; p < annotation.patterns.size(); ++p) {
    annotation.patterns[p].residual = report.patterns[p].floor;
  }
}

// What either way of making a mesh symmetric comes to.
struct Outcome {
  SymmetryAnnotation annotation;  // of the new mesh
  nlohmann::ordered_json json;
  std::string text;
};

Outcome move_vertices(const SymmetrizeArguments& arguments, const Mesh& mesh, SymmetryAnnotation annotation,
                      CommandContext& context) {
  SymmetrizeReport report;
  const Mesh result = symmetrized(mesh, annotation, context.run, &report);
  const SymmetryReport after = symmetry_residual(result, annotation, nullptr, CarriedMotions::fixed, context.run);
  context.run.check();
  write_edited(arguments.output, arguments.mesh, result, context.run);
  annotation.mesh_diagonal = diagonal(result.vertices);
  set_residuals(annotation, after);
  return {std::move(annotation), to_json(report, after), to_text(arguments.output, report, after)};
}

Outcome make_new_triangles(const SymmetrizeArguments& arguments, const Mesh& mesh, const SymmetryAnnotation& annotation,
                           CommandContext& context) {
  SymmetricRemesh result = symmetric_remesh(mesh, annotation, arguments.options, context.run);
  const SymmetryReport after =
      symmetry_residual(result.mesh, result.annotation, nullptr, CarriedMotions::fixed, context.run);
  context.run.check();
  const Appearance look = transferred(read_appearance(arguments.mesh, mesh), mesh, result.mesh, result.source_face,
                                      result.motions, result.motion_of_face);
  write_with_look(arguments.output, result.mesh, look, context.run);
  set_residuals(result.annotation, after);
  return {result.annotation, to_json(result, after), to_text(arguments.output, result, after)};
}

void check_arguments(const SymmetrizeArguments& arguments, bool min_score_given) {
  check_output(
      arguments.output,
      arguments.remesh ? std::vector<std::string>{".obj", ".off", ".ply", ".stl", ".glb"} : std::vector<std::string>{},
      {arguments.annotation});
  const std::vector<std::filesystem::path> others{arguments.mesh, arguments.output};
  if (!arguments.annotation_output.empty()) check_output(arguments.annotation_output, {".json"}, others);
  if (!arguments.report.empty()) {
    check_output(arguments.report, {".json"}, {arguments.mesh, arguments.annotation, arguments.annotation_output});
  }
  if (min_score_given && !arguments.remesh) throw UsageError("--min-score is for --remesh alone");
  arguments.options.validate();
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
  app.add_flag("--remesh", arguments->remesh,
               "New triangles that map onto one another, too: cut along a fundamental domain, images welded. Keeps "
               "regions and patterns of whole connected components");
  app.add_option("--min-score", arguments->options.min_score,
                 "With --remesh: exit with 1 if less than this share of a region's surface lies on itself under every "
                 "element, to within the annotation's tolerance")
      ->capture_default_str();
  app.add_option("--report", arguments->report, "What moved by how much, as --json prints it (.json)")
      ->type_name("FILE");
  return [arguments, &app](CommandContext& context) {
    check_arguments(*arguments, app.count("--min-score") > 0);
    const Mesh mesh = read_mesh(arguments->mesh);
    const SymmetryAnnotation given = without(arguments->without, read_annotation(arguments->annotation, mesh));
    if (arguments->remesh) require_scores(mesh, given, arguments->options, context.run);
    const SymmetryAnnotation annotation = made_consistent(mesh, given, context.run);
    const Outcome outcome = arguments->remesh ? make_new_triangles(*arguments, mesh, annotation, context)
                                              : move_vertices(*arguments, mesh, annotation, context);
    if (!arguments->annotation_output.empty()) write_annotation(arguments->annotation_output, outcome.annotation);
    if (!arguments->report.empty()) write_file(arguments->report, outcome.json.dump(2) + "\n");
    print(context, context.json ? outcome.json.dump(2) + "\n" : outcome.text);
    return kDone;
  };
}

}  // namespace orbifit::commands

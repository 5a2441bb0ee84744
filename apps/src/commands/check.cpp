#include <algorithm>
#include <memory>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "orbifit/datasets_tools/symmetry_residual.h"
#include "orbifit/model/annotation_io.h"
#include "orbifit/model/errors.h"
#include "orbifit/model/mesh_io.h"

#include "../commands.h"
#include "../file_content.h"
#include "../residual_json.h"

namespace orbifit::commands {

namespace {

struct CheckArguments {
  std::string mesh, annotation, deformed;
  std::string mode = "floating";
  double max_residual = 0;
};

CarriedMotions parse_mode(const std::string& text) {
  if (text == "fixed") return CarriedMotions::fixed;
  if (text == "posed") return CarriedMotions::posed;
  if (text == "floating") return CarriedMotions::floating;
  if (text == "moving") return CarriedMotions::moving;
  throw UsageError("--mode is '" + text + "': must be fixed, posed, floating or moving");
}

nlohmann::ordered_json to_json(const SymmetryReport& report, bool deformed, double worst) {
  nlohmann::ordered_json regions = nlohmann::ordered_json::array();
  for (const RegionResidual& region : report.regions) {
    nlohmann::ordered_json entry = {{"id", region.id},
                                    {"name", region.name},
                                    {"group", region.group},
                                    {"vertices", region.vertices},
                                    {"pairs", region.pairs},
                                    {"mapped_pairs", region.mapped},
                                    {"floor", to_json(region.floor)}};
    if (deformed) {
      entry["deformed"] = to_json(region.deformed);
      entry["excess"] = to_json(region.excess);
    }
    entry["worst_vertex"] = region.worst_vertex;
    regions.push_back(entry);
  }
  nlohmann::ordered_json patterns = nlohmann::ordered_json::array();
  for (const PatternResidual& pattern : report.patterns) {
    nlohmann::ordered_json entry = {{"id", pattern.id}, {"name", pattern.name}, {"floor", to_json(pattern.floor)}};
    if (deformed) entry["deformed"] = to_json(pattern.deformed);
    patterns.push_back(entry);
  }
  return {{"vertices_onto_vertices", report.vertices_onto_vertices},
          {"residual", worst},
          {"regions", regions},
          {"patterns", patterns}};
}

std::string region_table(const SymmetryReport& report, bool deformed) {
  std::vector<std::string> header{"region", "group", "vertices", "rest rms %", "rest max %"};
  if (deformed) header.insert(header.end(), {"deformed max %", "excess rms %", "excess max %"});
  header.insert(header.end(), {"worst vertex", "name"});
  TextTable table(header);
  for (const RegionResidual& region : report.regions) {
    std::vector<std::string> row{std::to_string(region.id), region.group, std::to_string(region.vertices),
                                 short_number(100 * region.floor.rms, 3), short_number(100 * region.floor.max, 3)};
    if (deformed) {
      row.push_back(short_number(100 * region.deformed.max, 3));
      row.push_back(short_number(100 * region.excess.rms, 3));
      row.push_back(short_number(100 * region.excess.max, 3));
    }
    row.push_back(region.worst_vertex < 0 ? "-" : std::to_string(region.worst_vertex));
    row.push_back(region.name);
    table.add(row);
  }
  return table.text();
}

std::string pattern_table(const SymmetryReport& report, bool deformed) {
  TextTable table(deformed ? std::vector<std::string>{"pattern", "rest max %", "deformed max %", "name"}
                           : std::vector<std::string>{"pattern", "rest max %", "name"});
  for (const PatternResidual& pattern : report.patterns) {
    std::vector<std::string> row{std::to_string(pattern.id), short_number(100 * pattern.floor.max, 3)};
    if (deformed) row.push_back(short_number(100 * pattern.deformed.max, 3));
    row.push_back(pattern.name);
    table.add(row);
  }
  return table.text();
}

std::string to_text(const SymmetryReport& report, bool deformed) {
  if (report.regions.empty() && report.patterns.empty()) return "The annotation holds no regions and no patterns.\n";
  std::string text;
  if (!report.regions.empty()) {
    text += region_table(report, deformed);
    text += report.vertices_onto_vertices
                ? "Vertices map onto vertices in every region: distances are between vertices.\n"
                : "Not all vertices map onto vertices: distances are to the surface between vertices.\n";
  }
  if (!report.patterns.empty()) text += pattern_table(report, deformed);
  text += "Distances are in percent of the diagonal.";
  if (deformed) text += " Excess is what the deformation adds to the distance at rest.";
  return text + "\n";
}

// What --max-residual judges: what the deformation adds, or without one the rest shape.
double worst_residual(const SymmetryReport& report, bool deformed) {
  double worst = deformed ? report.worst_excess : report.worst_floor;
  for (const PatternResidual& pattern : report.patterns) {
    worst = std::max(worst, deformed ? pattern.deformed.max - pattern.floor.max : pattern.floor.max);
  }
  return worst;
}

}  // namespace

CommandBody check(CLI::App& app) {
  const auto arguments = std::make_shared<CheckArguments>();
  app.add_option("MESH", arguments->mesh, "Mesh at rest")->required()->type_name("FILE");
  app.add_option("ANNOTATION", arguments->annotation, "Its annotation (.json)")->required()->type_name("FILE");
  app.add_option("--deformed", arguments->deformed, "The same mesh, deformed")->type_name("FILE");
  app.add_option(
         "--mode", arguments->mode,
         "How the groups may have moved: fixed (not at all), posed (by one common rigid motion), floating (also by a "
         "translation each) or moving (by a rigid motion each)")
      ->type_name("MODE")
      ->capture_default_str();
  app.add_option(
      "--max-residual", arguments->max_residual,
      "Exit with 1 if the residual (with --deformed its excess) exceeds this fraction of the diagonal (0.01 is "
      "1 %)");
  return [arguments, &app](CommandContext& context) {
    const bool limited = app.count("--max-residual") > 0;
    if (limited && !(arguments->max_residual >= 0)) {
      throw UsageError("--max-residual is " + short_number(arguments->max_residual) + ": must be at least 0");
    }
    parse_mode(arguments->mode);
    const Mesh mesh = read_mesh(arguments->mesh);
    const SymmetryAnnotation annotation = read_annotation(arguments->annotation, mesh);
    const bool has_deformed = !arguments->deformed.empty();
    const Mesh deformed = has_deformed ? read_mesh(arguments->deformed) : Mesh{};
    if (has_deformed && (deformed.vertices.rows() != mesh.vertices.rows() || deformed.faces != mesh.faces)) {
      throw InputError(
          arguments->deformed, "",
          "is no deformation of " + arguments->mesh + ": " +
              (deformed.vertices.rows() != mesh.vertices.rows() || deformed.faces.rows() != mesh.faces.rows()
                   ? "the counts of vertices and faces differ"
                   : "the faces join other vertices"));
    }
    context.run.check();
    const SymmetryReport report = symmetry_residual(mesh, annotation, has_deformed ? &deformed : nullptr,
                                                    parse_mode(arguments->mode), context.run);
    const double worst = worst_residual(report, has_deformed);
    if (context.json) {
      nlohmann::ordered_json json = to_json(report, has_deformed, worst);
      json["content"] = file_content(arguments->mesh, mesh);
      print(context, json.dump(2) + "\n");
    } else {
      print(context, to_text(report, has_deformed));
    }
    if (!limited || worst <= arguments->max_residual) return kDone;
    context.run.message("the residual " + short_number(worst) + " (" + percent(worst) +
                        " of the diagonal) is above the limit " + short_number(arguments->max_residual) + " (" +
                        percent(arguments->max_residual) + ")");
    return kNoResult;
  };
}

}  // namespace orbifit::commands

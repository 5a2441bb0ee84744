#include <filesystem>
#include <memory>
#include <optional>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "orbifit/fitting/placement.h"
#include "orbifit/model/annotation_io.h"
#include "orbifit/model/errors.h"
#include "orbifit/model/mesh_io.h"
#include "orbifit/model/scan_io.h"
#include "orbifit/subspace/handles.h"

#include "../commands.h"
#include "../picture_options.h"
#include "../subspace_arguments.h"
#include "comparison.h"
#include "comparison_report.h"
#include "files/file.h"
#include "registration/alignment.h"
#include "scan/clutter.h"

namespace orbifit::commands {

namespace {

namespace fs = std::filesystem;

struct CompareArguments {
  std::string mesh, scan, annotation, truth, handles, folder;
  std::vector<double> up;
  bool aligned = false;
  bool brief = false;
  ComparisonOptions options;
  SubspaceArguments subspace;
};

// All methods start from the same pose, and see the same part of the scan.
void place(const Mesh& mesh, const SymmetryAnnotation& annotation, const FitOptions& options, const RunContext& context,
           PointCloud& scan, Similarity& pose) {
  constexpr double kNear = 0.12;  // of the diagonal, as in fit()
  const auto found = find_placements(mesh, annotation, scan, options.placement, context, pose);
  if (found.empty()) throw NoResultError("the template was not found in the scan: give it aligned (--aligned)");
  pose = found.front().pose;
  scan = points_near(SurfaceIndex(mesh), diagonal(mesh.vertices), scan, pose, kNear, context);
}

std::optional<ComparisonTruth> read_truth(const std::string& file, const PointCloud& scan) {
  if (file.empty()) return std::nullopt;
  ComparisonTruth truth;
  truth.mesh = read_mesh(file);
  truth.visible = visible_vertices(truth.mesh, scan.points);
  return truth;
}

void write_comparison(const fs::path& folder, const Comparison& comparison) {
  write_file(folder / "comparison.csv", comparison_csv(comparison));
  write_file(folder / "comparison.json", comparison_json(comparison));
  write_file(folder / "comparison.txt", comparison_text(comparison));
  for (const MethodRun& run : comparison.runs) {
    if (run.failure.empty()) write_mesh(folder / (run.method + ".ply"), run.result.fitted);
  }
}

void add_options(CLI::App& app, CompareArguments& arguments) {
  app.add_option("TEMPLATE", arguments.mesh, "Mesh to fit")->required();
  app.add_option("SCAN", arguments.scan, "Points to fit it to; without them the handles alone edit the template");
  app.add_option("--annotation", arguments.annotation, "Annotation of the template (.json)")
      ->required()
      ->type_name("FILE");
  app.add_option("--truth", arguments.truth, "Mesh of the whole shape that was scanned, in the scan's frame")
      ->type_name("FILE");
  app.add_option("--handles", arguments.handles, "Handles and their motions (.json)")->type_name("FILE");
  app.add_option("-o,--output", arguments.folder, "Folder for the table, the page and the fitted meshes")
      ->required()
      ->type_name("DIR");
  app.add_option("--methods", arguments.options.methods, "Methods to compare; without it all of them")
      ->delimiter(',')
      ->type_name("METHOD,...");
  app.add_option("--weights", arguments.options.weights, "Weights of the symmetry penalty to sweep over")
      ->delimiter(',')
      ->type_name("W,...");
  app.add_option("--sizes", arguments.options.samples, "Numbers of surface samples to measure the time for")
      ->delimiter(',')
      ->type_name("N,...");
  app.add_flag("--brief", arguments.brief, "Only the table: no sweep of weights, no timing against sizes");
  app.add_flag("--aligned", arguments.aligned, "The scan is in the template's frame");
  add_up_option(app, arguments.up, "Upward direction of the pictures");
  add_subspace_options(app, arguments.subspace);
}

int run_compare(CompareArguments& arguments, CommandContext& context) {
  ComparisonOptions& options = arguments.options;
  if (arguments.scan.empty() && arguments.handles.empty()) throw UsageError("give a scan, or --handles, or both");
  if (arguments.scan.empty() && !arguments.truth.empty()) throw UsageError("--truth needs a scan");
  options.fit.subspace = arguments.subspace.options;
  options.validate();
  if (!arguments.up.empty()) to_direction("--up", arguments.up);
  const Mesh mesh = read_mesh(arguments.mesh);
  SymmetryAnnotation annotation = read_annotation(arguments.annotation, mesh);
  options.fit.subspace = subspace_options(arguments.subspace, mesh, context.run);
  build_consistent(mesh, annotation, options.fit.subspace, context.run);
  PointCloud scan;
  if (!arguments.scan.empty()) scan = read_scan(arguments.scan);
  std::vector<Handle> handles;
  if (!arguments.handles.empty()) handles = read_handles(arguments.handles, mesh).handles;
  const std::optional<ComparisonTruth> truth = read_truth(arguments.truth, scan);
  const Eigen::Vector3d up = picture_up(arguments.up, mesh, arguments.mesh, &annotation);
  const fs::path folder = arguments.folder;
  make_folder(folder);
  Similarity pose;
  if (!arguments.aligned && handles.empty()) place(mesh, annotation, options.fit, context.run, scan, pose);
  const FitInput input{mesh, annotation, scan, pose, {}, handles};
  if (arguments.brief) {
    options.weights.clear();
    options.samples.clear();
    options.meshes = 0;
  }
  const Comparison comparison = orbifit::compare(input, options, truth ? &*truth : nullptr, context.run);
  context.run.check();
  write_comparison(folder, comparison);
  write_file(folder / "index.html", comparison_html(comparison, scan, up, context.run));
  print(context, context.json ? comparison_json(comparison) : comparison_text(comparison));
  return kDone;
}

}  // namespace

CommandBody compare(CLI::App& app) {
  const auto arguments = std::make_shared<CompareArguments>();
  add_options(app, *arguments);
  return [arguments](CommandContext& context) { return run_compare(*arguments, context); };
}

}  // namespace orbifit::commands

#include "orbifit/fitting/fit.h"

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "orbifit/datasets_tools/symmetry_residual.h"
#include "orbifit/detection/detect.h"
#include "orbifit/fitting/fit_verdict.h"
#include "orbifit/model/annotation_io.h"
#include "orbifit/model/consistent_annotation.h"
#include "orbifit/model/errors.h"
#include "orbifit/model/mesh_io.h"
#include "orbifit/subspace/handles.h"

#include "../commands.h"
#include "../edit_warnings.h"
#include "../fit_report.h"
#include "../of_file.h"
#include "../picture_options.h"
#include "../subspace_arguments.h"
#include "files/file.h"
#include "fit_scans.h"

namespace orbifit::commands {

namespace {

struct FitArguments {
  std::string mesh, annotation, output, report, html, landmarks, handles, annotation_output;
  std::vector<double> up;
  ScanArguments scans;
  std::string scale = "any";
  bool aligned = false;
  bool no_contacts = false;
  std::vector<int> without;
  double max_residual = 0;
  FitOptions options;
  SubspaceArguments subspace;
};

void check_outputs(const FitArguments& arguments) {
  std::vector<std::filesystem::path> inputs{arguments.annotation};
  for (const std::vector<std::string>* files : {&arguments.scans.files, &arguments.scans.masks}) {
    inputs.insert(inputs.end(), files->begin(), files->end());
  }
  if (!arguments.scans.extrinsics.empty()) inputs.emplace_back(arguments.scans.extrinsics);
  check_output(arguments.output, {}, inputs);
  inputs.emplace_back(arguments.mesh);
  if (!arguments.report.empty()) check_output(arguments.report, {".json"}, inputs);
  if (!arguments.html.empty()) check_output(arguments.html, {".html", ".htm"}, inputs);
  if (!arguments.annotation_output.empty()) check_output(arguments.annotation_output, {".json"}, inputs);
}

std::string named(const std::vector<std::string>& files) {
  return files.front() +
         (files.size() > 1 ? " and " + count_of(static_cast<long long>(files.size()) - 1, "other") : "");
}

void tell_used(const ScanArguments& arguments, const std::vector<PointCloud>& scans, int most, const RunContext& run) {
  long long points = 0;
  for (const PointCloud& scan : scans) points += scan.points.rows();
  if (points <= most) return;
  run.message(named(arguments.files) + ": " + std::to_string(most) + " of " +
              (arguments.files.size() > 1 ? "their " : "its ") + count_of(points, "point") +
              " are used (--scan-points)");
}

std::string to_text(const FitArguments& arguments, const std::vector<std::string>& verdict, const FitResult& result,
                    const SymmetryReport& symmetry) {
  double seconds = 0;
  for (const StageTime& time : result.times) seconds += time.seconds;
  std::string text = arguments.output + ": " + percent(result.inlier_ratio) + " of the scan " +
                     (result.overlap < 1 ? "(" + percent(1 - result.overlap) + " left out) " : "") + "within " +
                     percent(arguments.options.inlier_distance) + " of the diagonal (rms " + percent(result.rms) +
                     "), " + percent(result.hidden_fraction) + " of the surface not seen; " +
                     exactness(result.field_residual) + "\n";
  text +=
      "symmetry residual added to the mesh: " + short_number(100 * symmetry.worst_excess, 3) + " % of the diagonal\n";
  text += count_of(static_cast<long long>(result.iterations.size()), "iteration") + " with " +
          count_of(result.degrees_of_freedom, "degree of freedom", "degrees of freedom") + " in " +
          short_number(seconds, 3) + " s; " + result.stopped_because + "\n";
  for (const std::string& sentence : verdict) text += sentence + "\n";
  return text;
}

void add_file_options(CLI::App& app, FitArguments& arguments) {
  app.add_option("TEMPLATE", arguments.mesh, "Mesh to deform and place so that it fits the scan")->required();
  add_scan_options(app, arguments.scans);
  app.add_option("--annotation", arguments.annotation,
                 "The template's annotation; without it, the symmetries are detected")
      ->type_name("FILE");
  app.add_option("-o,--output", arguments.output, "Fitted mesh to write")->required()->type_name("FILE");
  app.add_option("--report", arguments.report, "Report with all figures to write (.json)")->type_name("FILE");
  app.add_option("--html", arguments.html, "Page with figures and pictures to write (.html)")->type_name("FILE");
  app.add_option("--annotation-out", arguments.annotation_output, "Annotation of the fitted mesh to write (.json)")
      ->type_name("FILE");
  app.add_option("--landmarks", arguments.landmarks, "Vertices of the template and their positions in the scan (.json)")
      ->type_name("FILE");
  app.add_option("--handles", arguments.handles, "Handles and their motions (.json)")->type_name("FILE");
}

void add_fit_options(CLI::App& app, FitArguments& arguments) {
  app.add_option("--scale", arguments.scale, "Size of the template in the scan: any, or that of its file (fixed)")
      ->check(CLI::IsMember({"any", "fixed"}))
      ->capture_default_str();
  app.add_flag("--aligned", arguments.aligned,
               "The scan is in the template's frame: the pose is neither sought nor refined");
  app.add_option(
         "--max-residual", arguments.max_residual,
         "Write no mesh and exit with 1 if the symmetry residual of the fit exceeds this fraction of the diagonal")
      ->type_name("R");
  add_without_option(app, arguments.without);
  app.add_flag("--drop-unsupported", arguments.options.drop_unsupported,
               "Drop the groups that an unconstrained fit to the scan contradicts");
  app.add_flag("--auto-relax", arguments.options.drop_unsupported)->group("");  // what --drop-unsupported was called
  app.add_flag("--no-contacts", arguments.no_contacts, "Allow parts of the template that touch to come apart");
  app.add_option("--stiffness", arguments.options.last_stiffness,
                 "Stiffness in the last iterations; a smaller value follows the scan more closely")
      ->capture_default_str();
  app.add_option("--refinements", arguments.options.refinements,
                 "How often the subspace may be made finer, by three times the degrees of freedom, where the scan asks "
                 "for it; not where --samples or --radius say how fine it is")
      ->capture_default_str()
      ->check(CLI::Range(0, 4));
  app.add_flag(
      "--detail", arguments.options.detail,
      "At last move the vertices along their normals, as symmetrically, to detail that is too fine for the subspace");
  app.add_option("--scan-points", arguments.options.scan_points, "Number of scan points used")->capture_default_str();
  add_up_option(app, arguments.up, "Upward direction of the pictures");
  add_subspace_options(app, arguments.subspace);
}

void choose_options(const CLI::App& app, FitArguments& arguments) {
  if (app.count("--max-residual") > 0 && !(arguments.max_residual >= 0)) {
    throw UsageError("--max-residual is " + short_number(arguments.max_residual) + ": must be at least 0");
  }
  FitOptions& chosen = arguments.options;
  chosen.place = !arguments.aligned && arguments.handles.empty();
  chosen.align = !arguments.aligned;
  chosen.fixed_scale = arguments.scale == "fixed";
  chosen.contacts = !arguments.no_contacts;
  chosen.subspace = arguments.subspace.options;
  chosen.validate();
  if (!arguments.up.empty()) to_direction("--up", arguments.up);
}

SymmetryAnnotation template_annotation(const FitArguments& arguments, const Mesh& mesh, RunContext& run) {
  SymmetryAnnotation annotation =
      arguments.annotation.empty()
          ? of_file(arguments.mesh, [&] { return orbifit::detect(mesh, DetectOptions{}, run); })
          : read_annotation(arguments.annotation, mesh);
  return arguments.without.empty() ? annotation : without(arguments.without, annotation);
}

// `annotation`, the input's, becomes what of it is consistent.
StageTime make_consistent(SymmetryAnnotation& annotation, FitInput& input, const RunContext& run) {
  const auto began = std::chrono::steady_clock::now();
  ConsistentAnnotation consistent = consistent_annotation(input.mesh, annotation, run);
  tell_changes(consistent, run);
  annotation = std::move(consistent.annotation);
  input.surface_index = std::move(consistent.surface_index);
  return {"consistency", std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count()};
}

// What only the template tells of the fit's symmetry is found beside the fit, where there are threads for both.
FitResult fit_and_pair(const FitInput& input, const FitOptions& options, const RunContext& run,
                       std::optional<SymmetryPairs>& pairs) {
  if (run.threads < 2) return orbifit::fit(input, options, run);
  RunContext silent = run;
  silent.on_progress = nullptr;
  FitResult result;
  parallel_for(run, 2, [&](std::size_t begin, std::size_t end) {
    for (std::size_t task = begin; task < end; ++task) {
      if (task == 0) {
        pairs.emplace(input.mesh, input.annotation, silent);
      } else {
        result = orbifit::fit(input, options, run);
      }
    }
  });
  return result;
}

FitResult prepare_and_fit(const FitArguments& arguments, SymmetryAnnotation& annotation, FitInput& input,
                          RunContext& run, std::optional<SymmetryPairs>& pairs) {
  const StageTime agreeing = make_consistent(annotation, input, run);
  if (!arguments.landmarks.empty()) input.landmarks = read_landmarks(arguments.landmarks, input.mesh);
  if (!arguments.handles.empty()) input.handles = read_handles(arguments.handles, input.mesh).handles;
  FitResult result = fit_and_pair(input, arguments.options, run, pairs);
  result.times.insert(result.times.begin(), agreeing);
  return result;
}

// \throw NoResultError  when the fit failed or misses --max-residual
void require_fit(const CLI::App& app, const FitArguments& arguments, const FitResult& result) {
  if (!result.converged) {
    throw NoResultError("the fit of " + arguments.mesh + " to " + named(arguments.scans.files) +
                        " failed: " + result.stopped_because);
  }
  if (app.count("--max-residual") > 0 && !(result.field_residual <= arguments.max_residual)) {
    throw NoResultError("the fit is only " + exactness(result.field_residual) + ", above --max-residual " +
                        short_number(arguments.max_residual) + "; no mesh was written");
  }
}

int run_fit(const CLI::App& app, FitArguments& arguments, CommandContext& context) {
  choose_options(app, arguments);
  check_outputs(arguments);
  FitOptions& chosen = arguments.options;
  const Mesh mesh = read_mesh(arguments.mesh);
  chosen.subspace = subspace_options(arguments.subspace, mesh, context.run);
  const std::vector<PointCloud> scans = read_scans(arguments.scans, arguments.aligned, context);
  tell_used(arguments.scans, scans, chosen.scan_points, context.run);
  SymmetryAnnotation annotation = template_annotation(arguments, mesh, context.run);
  chosen.judge_groups = !arguments.report.empty() || !arguments.html.empty() || context.json;
  FitInput input{mesh, annotation, scans.front(), Similarity{}};
  for (std::size_t i = 1; i < scans.size(); ++i) input.others.push_back(&scans[i]);
  std::optional<SymmetryPairs> pairs;
  const FitResult result = prepare_and_fit(arguments, annotation, input, context.run, pairs);
  if (!pairs || !result.dropped.empty()) pairs.emplace(mesh, result.rest_annotation, context.run);
  const SymmetryReport symmetry = pairs->residual(&result.fitted, CarriedMotions::moving, context.run);
  const std::vector<std::string> verdict = fit_verdict(result);
  context.run.check();
  // A fit that failed leaves its report, which says why, but no mesh that could be taken for a result.
  if (!arguments.report.empty()) write_file(arguments.report, fit_to_json(verdict, result, symmetry).dump(2) + "\n");
  if (!arguments.html.empty()) {
    const Eigen::Vector3d up = picture_up(arguments.up, mesh, arguments.mesh, &annotation);
    write_file(arguments.html,
               fit_to_html(mesh, joined_scans(scans, result), result, verdict, symmetry, up, context.run));
  }
  require_fit(app, arguments, result);
  if (result.field_residual > kExactResidual) {
    context.run.message("warning: the fit is only " + exactness(result.field_residual));
  }
  write_edited(arguments.output, arguments.mesh, result.fitted, context.run);
  if (!arguments.annotation_output.empty()) write_annotation(arguments.annotation_output, result.annotation);
  print(context, context.json ? fit_to_json(verdict, result, symmetry).dump(2) + "\n"
                              : to_text(arguments, verdict, result, symmetry));
  return kDone;
}

}  // namespace

CommandBody fit(CLI::App& app) {
  const auto arguments = std::make_shared<FitArguments>();
  add_file_options(app, *arguments);
  add_fit_options(app, *arguments);
  return [arguments, &app](CommandContext& context) { return run_fit(app, *arguments, context); };
}

}  // namespace orbifit::commands

#include "detection.h"

#include <algorithm>
#include <filesystem>
#include <memory>

#include <CLI/CLI.hpp>

#include "orbifit/datasets_tools/truth.h"
#include "orbifit/detection/detect.h"
#include "orbifit/model/annotation_io.h"
#include "orbifit/model/errors.h"
#include "orbifit/model/mesh_io.h"

#include "benchmarks.h"
#include "files/file.h"
#include "stage_run.h"
#include "stopwatch.h"

namespace orbifit::benchmarks {

namespace fs = std::filesystem;

namespace {

struct DetectionOptions {
  std::vector<std::string> models, forms{"assembly", "remesh"};
  std::vector<double> noise{0};
  bool cut = false;
  bool again = false;
  std::string json, folder;
  StageRun stages;
  DetectOptions detect;
};

void check(const DetectionOptions& options) {
  options.detect.validate();
  for (const double noise : options.noise) {
    if (!(noise >= 0 && noise <= 0.1))
      throw UsageError("--noise is " + short_number(noise) + ": must be from 0 to 0.1");
  }
  if (!options.json.empty()) check_output(options.json);
}

// Those of the suite that are asked for by name or kind, in its order.
std::vector<SuiteModel> chosen_models(const std::vector<std::string>& wanted) {
  std::vector<SuiteModel> all = detection_suite();
  for (const std::string& name : wanted) {
    if (std::ranges::none_of(all, [&](const SuiteModel& model) { return model.name == name || model.kind == name; })) {
      throw UsageError("--models: the suite has no model or kind '" + name + "'");
    }
  }
  if (wanted.empty()) return all;
  std::erase_if(all, [&](const SuiteModel& model) {
    return std::ranges::find(wanted, model.name) == wanted.end() &&
           std::ranges::find(wanted, model.kind) == wanted.end();
  });
  return all;
}

std::vector<CaseForm> chosen_forms(const DetectionOptions& options) {
  std::vector<CaseForm> forms;
  for (const std::string& form : options.forms) {
    for (const double noise : options.noise) forms.push_back({form == "remesh", noise, false});
    if (options.cut) forms.push_back({form == "remesh", 0, true});
  }
  return forms;
}

void make_folder(const fs::path& folder) {
  std::error_code code;
  fs::create_directory(folder, code);
  if (!fs::is_directory(folder)) {
    throw InputError(folder.string(), "", "is no folder and cannot be made" + (code ? ": " + code.message() : ""));
  }
}

DetectionRow measure(const SuiteModel& suite_model, const CaseForm& form, const DetectionOptions& options,
                     RunContext& context) {
  DetectionRow row;
  row.model = suite_model.name;
  row.kind = suite_model.kind;
  row.form = form;
  TruthModel model;
  try {
    model = case_of(suite_model, form, context);
  } catch (const InterruptedError&) {
    throw;
  } catch (const Error& error) {
    row.failure = error.what();
    return row;
  }
  row.vertices = static_cast<int>(model.mesh.vertices.rows());
  row.faces = static_cast<int>(model.mesh.faces.rows());
  const fs::path file = fs::path(options.folder) / (row.model + "-" + form.file_name());
  if (!options.folder.empty()) {
    write_mesh(file.string() + ".ply", model.mesh);
    write_truth(file.string() + ".truth.json", model.truth);
  }
  SymmetryAnnotation detected = empty_annotation(model.mesh, options.detect.tolerance);
  const double start = seconds_now();
  try {
    detected = orbifit::detect(model.mesh, options.detect, context);
  } catch (const InterruptedError&) {
    throw;
  } catch (const Error& error) {
    row.failure = error.what();
  }
  row.seconds = seconds_now() - start;
  row.optional = static_cast<int>(model.truth.optional_regions.size() + model.truth.optional_patterns.size());
  row.regions = static_cast<int>(detected.regions.size());
  row.within_tolerance = static_cast<int>(std::ranges::count_if(
      detected.regions, [&](const Region& region) { return region.residual.max <= detected.tolerance; }));
  if (options.again && row.failure.empty()) row.again = found_again(model.mesh, detected, options.detect, context);
  if (!options.folder.empty()) write_annotation(file.string() + ".detected.json", detected);
  row.score = score_detection(model.mesh, detected, &model.truth, {}, context);
  return row;
}

// A run takes minutes: how it goes.
std::string in_short(const DetectionRow& row) {
  if (!row.failure.empty()) return row.failure;
  const DetectionSummary& summary = row.score.summary;
  return std::to_string(summary.predicted) + " found, " + std::to_string(summary.expected.value_or(0)) +
         " expected, F1 " + short_number(summary.f1.value_or(0), 3) + ", " + short_number(row.seconds, 3) + " s";
}

int run(const DetectionOptions& options, const CommandContext& given) {
  check(options);
  const std::vector<SuiteModel> models = chosen_models(options.models);
  const std::vector<CaseForm> forms = chosen_forms(options);
  if (!options.folder.empty()) make_folder(options.folder);
  RunContext context = stage_context(given, options.stages);
  std::vector<DetectionRow> rows;
  const auto report = [&] {
    if (!options.json.empty()) write_file(options.json, detection_json(rows));
    print(detection_text(rows));
  };
  try {
    for (std::size_t m = 0; m < models.size(); ++m) {
      for (const CaseForm& form : forms) {
        given.run.check();
        given.run.message(std::to_string(m + 1) + "/" + std::to_string(models.size()) + " " + models[m].name + ", " +
                          form.name() + (form.noise > 0 ? ", noise " + short_number(form.noise) : ""));
        rows.push_back(measure(models[m], form, options, context));
        given.run.message("  " + in_short(rows.back()));
      }
    }
  } catch (const InterruptedError&) {
    report();  // of what was measured until then
    throw;
  }
  report();
  return kDone;
}

}  // namespace

CommandBody detection(CLI::App& app) {
  auto options = std::make_shared<DetectionOptions>();
  app.add_option("--models", options->models, "Only these models or kinds of the suite")
      ->delimiter(',')
      ->type_name("NAME,...");
  app.add_option("--forms", options->forms,
                 "As assembled from parts, and as one remeshed surface; both where not given")
      ->delimiter(',')
      ->check(CLI::IsMember({"assembly", "remesh"}))
      ->type_name("FORM,...");
  app.add_option("--noise", options->noise, "Standard deviations along the normals, fractions of the diagonal")
      ->delimiter(',')
      ->type_name("S,...");
  app.add_flag("--cut", options->cut, "Each form also without a fifth of its area");
  app.add_flag("--again", options->again,
               "Detect each mesh in two other orders and two other poses as well, and count what is found again");
  app.add_option("--tolerance", options->detect.tolerance, "The detector's, a fraction of the diagonal")
      ->capture_default_str();
  app.add_option("--max-seconds", options->detect.time_budget)->group("");  // what --time-budget was called
  app.add_option("--time-budget", options->detect.time_budget, "Seconds of detection for each mesh; 0: no limit")
      ->capture_default_str();
  add_stage_run(app, options->stages, "poses, noise, cuts and the detector");
  app.add_option("--write", options->folder,
                 "Write each mesh, its truth and its detection; the folder is made if missing")
      ->type_name("FOLDER");
  app.add_option("--json", options->json, "Write rows and means to a file")->type_name("FILE");
  return [options](CommandContext& context) { return run(*options, context); };
}

}  // namespace orbifit::benchmarks

#include "baselines.h"

#include <algorithm>
#include <memory>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "orbifit/model/errors.h"

#include "benchmarks.h"
#include "cases/fit_cases.h"
#include "comparison_report.h"
#include "divided.h"
#include "files/file.h"
#include "stage_run.h"

namespace orbifit::benchmarks {

namespace {

struct BaselinesOptions {
  std::vector<std::string> families{"fan", "armchair"}, tasks{"scan", "handles", "conflict"}, methods;
  int sizes = 3;
  std::string json;
  StageRun stages;
};

Handle handle_at(const Mesh& mesh, const Eigen::Vector3d& direction, const std::string& name) {
  constexpr double kHandleRadius = 0.08;  // of the diagonal
  Eigen::Index end = 0;
  (mesh.vertices * direction).maxCoeff(&end);
  const double radius = kHandleRadius * diagonal(mesh.vertices);
  Handle handle;
  handle.name = name;
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
    if ((mesh.vertices.row(v) - mesh.vertices.row(end)).norm() <= radius) {
      handle.vertices.push_back(static_cast<int>(v));
    }
  }
  return handle;
}

// The foot is held and one side is pulled out. In conflict with the symmetry the other side is held as well.
std::vector<Handle> handles_of(const Mesh& mesh, bool conflict) {
  constexpr double kPull = 0.06;  // of the diagonal
  const Eigen::Vector3d side = Eigen::Vector3d(1, 0.1, 0.3).normalized();
  std::vector<Handle> handles{handle_at(mesh, -Eigen::Vector3d::UnitZ(), "foot"), handle_at(mesh, side, "side")};
  handles.back().motion.translation = kPull * diagonal(mesh.vertices) * Eigen::Vector3d::UnitX();
  const Eigen::Vector3d other_side(-side.x(), side.y(), side.z());
  if (conflict) handles.push_back(handle_at(mesh, other_side, "other side"));
  return handles;
}

void run_task(const std::string& task, const FitCase& each, const AnnotatedMesh& sized, const BaselinesOptions& options,
              RunContext& context, std::vector<BaselineRow>& rows, const RunContext& given) {
  const PointCloud none;
  const bool scan = task == "scan";
  FitInput input{sized.mesh, sized.annotation, scan ? each.scan : none, each.pose};
  if (!scan) input.handles = handles_of(sized.mesh, task == "conflict");
  FitOptions chosen;
  chosen.align = false;
  chosen.condition = true;
  if (sized.mesh.faces.rows() > each.model.mesh.faces.rows()) chosen = with_few_iterations(chosen);
  const ComparisonTruth truth{each.truth, each.visible};
  for (const Method& method : methods()) {
    if (!options.methods.empty() && std::ranges::find(options.methods, method.name) == options.methods.end()) continue;
    given.check();
    // Its null space depends on the samples, which stay, and takes as long each time.
    if (method.name == "svd-nullspace" && sized.mesh.faces.rows() > each.model.mesh.faces.rows()) continue;
    const MethodRun run = run_method(method, method.weight, input, chosen, scan ? &truth : nullptr, context);
    given.message(each.name + ", " + task + ", " + std::to_string(run.faces) + " faces, " + run.method + ": " +
                  (run.failure.empty() ? short_number(1000 * run.iteration, 3) + " ms an iteration" : run.failure));
    rows.push_back({each.name, task, run});
  }
}

int run(const BaselinesOptions& options, const CommandContext& given) {
  if (!options.json.empty()) check_output(options.json, {".json"});
  if (options.sizes < 1 || options.sizes > 5) throw UsageError("--sizes must be from 1 to 5");
  RunContext context = stage_context(given, options.stages);
  std::vector<BaselineRow> rows;
  for (const std::string& name : options.families) {
    const auto family = std::ranges::find(fit_families(), name, &FitFamily::name);
    if (family == fit_families().end()) throw UsageError("--families: there is no family '" + name + "'");
    const FitCase each = fit_case(*family, FitLevel::one_view, context);
    AnnotatedMesh sized{each.model.mesh, each.model.truth};
    for (int size = 0; size < options.sizes; ++size) {
      if (size > 0) sized = divided(sized.mesh, sized.annotation);
      for (const std::string& task : options.tasks) run_task(task, each, sized, options, context, rows, given.run);
    }
  }
  if (!options.json.empty()) write_file(options.json, baselines_json(rows));
  print(baselines_text(rows));
  return kDone;
}

}  // namespace

std::string baselines_json(const std::vector<BaselineRow>& rows) {
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const BaselineRow& row : rows) {
    nlohmann::ordered_json entry{{"family", row.family}, {"task", row.task}};
    entry.update(run_json(row.run));
    all.push_back(entry);
  }
  return nlohmann::ordered_json{{"rows", all}}.dump(2) + "\n";
}

std::string baselines_text(const std::vector<BaselineRow>& rows) {
  std::string text;
  for (std::size_t first = 0; first < rows.size();) {
    std::size_t last = first;
    Comparison together;
    double ours = 0;
    while (last < rows.size() && rows[last].family == rows[first].family && rows[last].task == rows[first].task &&
           rows[last].run.faces == rows[first].run.faces) {
      together.runs.push_back(rows[last].run);
      if (rows[last].run.method == "ours") ours = rows[last].run.iteration;
      ++last;
    }
    text += rows[first].family + ", " + rows[first].task + ", " + std::to_string(rows[first].run.faces) + " faces\n" +
            comparison_text(together);
    for (const MethodRun& run : together.runs) {
      if (run.method != "kurz" || !run.failure.empty() || !(ours > 0)) continue;
      text += "  an iteration of kurz takes " + short_number(run.iteration / ours, 3) + " times as long as ours\n";
    }
    text += "\n";
    first = last;
  }
  return text;
}

CommandBody baselines(CLI::App& app) {
  auto options = std::make_shared<BaselinesOptions>();
  app.add_option("--families", options->families, "Of these families")->delimiter(',')->type_name("NAME,...");
  app.add_option("--tasks", options->tasks, "A scan, handles, handles that contradict the symmetry")
      ->delimiter(',')
      ->check(CLI::IsMember({"scan", "handles", "conflict"}))
      ->type_name("TASK,...");
  app.add_option("--methods", options->methods, "Only these methods")
      ->delimiter(',')
      ->check(CLI::IsMember([] {
        std::vector<std::string> names;
        for (const Method& method : methods()) names.push_back(method.name);
        return names;
      }()))
      ->type_name("METHOD,...");
  app.add_option("--sizes", options->sizes,
                 "Sizes of the template, each with four times the faces of the one before: the first is fitted, "
                 "others are timed by six iterations")
      ->capture_default_str();
  add_stage_run(app, options->stages, "the scans and the fits");
  app.add_option("--json", options->json, "Write the rows to a file")->type_name("FILE");
  return [options](CommandContext& context) { return run(*options, context); };
}

}  // namespace orbifit::benchmarks

#include "fitting.h"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <numeric>

#include <CLI/CLI.hpp>

#include "orbifit/datasets_tools/symmetry_residual.h"
#include "orbifit/fitting/alignment.h"
#include "orbifit/fitting/fit.h"
#include "orbifit/model/annotation_io.h"
#include "orbifit/model/errors.h"
#include "orbifit/model/file.h"
#include "orbifit/model/mesh_io.h"
#include "orbifit/model/scan_io.h"

#include "benchmarks.h"
#include "stopwatch.h"

namespace orbifit::benchmarks {

namespace fs = std::filesystem;

namespace {

struct FittingOptions {
  std::vector<std::string> families, levels, methods;
  std::string json, folder;
  int threads = 1;
  std::uint64_t seed = 1;
};

struct Level {
  const char* name;
  FitLevel level;
};
constexpr Level kLevels[] = {
    {"3views", FitLevel::three_views}, {"1view", FitLevel::one_view}, {"anywhere", FitLevel::anywhere}};

constexpr const char* kMethods[] = {"ours", "rigid", "free", "copied"};

// The scan and its images under the known groups of the whole shape, in the scan's frame.
PointCloud copied_scan(const FitCase& each) {
  PointCloud result = each.scan;
  for (const Region& region : each.model.truth.regions) {
    if (static_cast<Eigen::Index>(region.faces.size()) != each.model.mesh.faces.rows()) continue;
    for (const Motion& element : region.elements) {
      const Motion there = conjugate(each.pose, element);
      if ((there.linear - Eigen::Matrix3d::Identity()).norm() < 1e-9) continue;
      const auto append = [&](Points& to, const Points& from) {
        const Eigen::Index rows = to.rows();
        to.conservativeResize(rows + from.rows(), 3);
        to.bottomRows(from.rows()) = (from * there.linear.transpose()).rowwise() + there.translation.transpose();
      };
      append(result.points, each.scan.points);
      append(result.viewpoints, each.scan.viewpoints);
    }
  }
  return result;
}

// Without symmetry every sample moves by itself.
SymmetryAnnotation without_symmetry(const GeneratedModel& model) {
  SymmetryAnnotation none = model.truth;
  none.regions.clear();
  none.patterns.clear();
  return none;
}

// Similarity ICP from the true pose of the template; nothing is deformed.
FitResult rigid_fit(const FitCase& each, RunContext& context) {
  const PreparedScan scan = prepare_scan(each.scan, {}, context);
  std::vector<int> all(static_cast<std::size_t>(scan.points.rows()));
  std::iota(all.begin(), all.end(), 0);
  const Mesh& mesh = each.model.mesh;
  FitResult result;
  result.pose = align_with_scale(mesh, MatchSurface(mesh), scan, all, each.pose, {});
  result.fitted = mesh;
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
    result.fitted.vertices.row(v) = result.pose(mesh.vertices.row(v).transpose()).transpose();
  }
  result.converged = true;
  return result;
}

FittingRow measure(const FitCase& each, const char* level, const std::string& method, const FittingOptions& options,
                   RunContext& context) {
  FittingRow row;
  row.family = each.name;
  row.level = level;
  row.method = method;
  FitOptions chosen;
  // Only ours has to find the pose: the others are given the true one.
  chosen.place = method == "ours" && each.level == FitLevel::anywhere;
  chosen.align = false;
  const SymmetryAnnotation annotation = method == "ours" ? each.model.truth : without_symmetry(each.model);
  const PointCloud scan = method == "copied" ? copied_scan(each) : each.scan;
  const FitInput input{each.model.mesh, annotation, scan, chosen.place ? Similarity{} : each.pose, {}, {}};
  const double start = seconds_now();
  try {
    const FitResult result = method == "rigid" ? rigid_fit(each, context) : fit(input, chosen, context);
    row.seconds = seconds_now() - start;
    row.fitted = result.converged;
    if (!result.converged) row.failure = result.stopped_because;
    row.degrees_of_freedom = result.degrees_of_freedom;
    for (const StageTime& time : result.times) {
      if (time.stage == "placement") row.placing = time.seconds;
      if (time.stage == "fit" && !result.iterations.empty()) {
        row.iteration = time.seconds / static_cast<double>(result.iterations.size());
      }
    }
    row.score = score_fit(each, result.fitted, context);
    row.symmetry = symmetry_residual(each.model.mesh, each.model.truth, &result.fitted, CarriedMotions::moving, context)
                       .worst_excess;
    if (!options.folder.empty()) {
      const std::string base = (fs::path(options.folder) / (row.family + "-" + row.level)).string();
      write_mesh(base + "-" + method + ".ply", result.fitted);
      write_mesh(base + "-truth.ply", each.truth);
      write_mesh(base + "-template.ply", each.model.mesh);
      write_annotation(base + "-template.json", each.model.truth);
      write_scan(base + "-scan.ply", each.scan);
    }
  } catch (const InterruptedError&) {
    throw;
  } catch (const Error& error) {
    row.failure = error.what();
  }
  return row;
}

bool asked(const std::vector<std::string>& wanted, const std::string& name) {
  return wanted.empty() || std::ranges::find(wanted, name) != wanted.end();
}

int run(const FittingOptions& options, const CommandContext& given) {
  if (options.threads < 1 || options.threads > 4096) {
    throw UsageError("--threads is " + std::to_string(options.threads) + ": must be from 1 to 4096");
  }
  for (const std::string& name : options.families) {
    if (std::ranges::none_of(fit_families(), [&](const FitFamily& family) { return family.name == name; })) {
      throw UsageError("--families: there is no family '" + name + "'");
    }
  }
  if (!options.json.empty()) check_output(options.json);
  RunContext context = given.run;
  context.on_message = nullptr;  // of the stages
  context.threads = options.threads;
  context.seed = options.seed;
  std::vector<FittingRow> rows;
  for (const FitFamily& family : fit_families()) {
    if (!asked(options.families, family.name)) continue;
    for (const Level& level : kLevels) {
      if (!asked(options.levels, level.name)) continue;
      const FitCase each = fit_case(family, level.level, context);
      for (const char* method : kMethods) {
        if (!asked(options.methods, method)) continue;
        given.run.check();
        rows.push_back(measure(each, level.name, method, options, context));
        const FittingRow& row = rows.back();
        given.run.message(
            row.family + ", " + row.level + ", " + row.method + ": " +
            (row.fitted ? "hidden " + short_number(100 * row.score.hidden, 3) + " %, " : row.failure + ", ") +
            short_number(row.seconds, 3) + " s");
      }
    }
  }
  if (!options.json.empty()) write_file(options.json, fitting_json(rows));
  print(fitting_text(rows));
  return kDone;
}

}  // namespace

CommandBody fitting(CLI::App& app) {
  auto options = std::make_shared<FittingOptions>();
  app.add_option("--families", options->families, "Only these families")->delimiter(',')->type_name("NAME,...");
  app.add_option("--levels", options->levels, "Only these levels")
      ->delimiter(',')
      ->check(CLI::IsMember({"3views", "1view", "anywhere"}))
      ->type_name("LEVEL,...");
  app.add_option("--methods", options->methods, "Only these methods")
      ->delimiter(',')
      ->check(CLI::IsMember({"ours", "rigid", "free", "copied"}))
      ->type_name("METHOD,...");
  app.add_option("--seed", options->seed, "Of poses, noise and the fit")->capture_default_str();
  app.add_option("--threads", options->threads, "Threads to use")->type_name("N")->capture_default_str();
  app.add_option("--write", options->folder, "Write templates, scans, truths and fits into this folder")
      ->check(CLI::ExistingDirectory)
      ->type_name("FOLDER");
  app.add_option("--json", options->json, "Write rows and means to a file")->type_name("FILE");
  return [options](CommandContext& context) { return run(*options, context); };
}

}  // namespace orbifit::benchmarks

#include "fitting.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <limits>
#include <memory>
#include <optional>

#include <CLI/CLI.hpp>

#include "orbifit/baselines/full_sampling.h"
#include "orbifit/baselines/similarity_fit.h"
#include "orbifit/datasets_tools/symmetry_residual.h"
#include "orbifit/fitting/fit.h"
#include "orbifit/model/annotation_io.h"
#include "orbifit/model/errors.h"
#include "orbifit/model/mesh_io.h"
#include "orbifit/model/scan_io.h"

#include "benchmarks.h"
#include "files/file.h"
#include "fitting_shapes.h"
#include "peers/pcl_pose.h"
#include "registration/alignment.h"
#include "scan/clutter.h"
#include "stage_run.h"
#include "stopwatch.h"

namespace orbifit::benchmarks {

namespace fs = std::filesystem;

namespace {

struct FittingOptions {
  std::vector<std::string> families, levels, methods;
  std::string json, folder;
  StageRun stages;
};

struct Level {
  const char* name;
  FitLevel level;
};
constexpr Level kLevels[] = {{"3views", FitLevel::three_views},
                             {"1view", FitLevel::one_view},
                             {"anywhere", FitLevel::anywhere},
                             {"shapes", FitLevel::other_shape},
                             {"several", FitLevel::several}};

constexpr double kSoftWeight = 100;  // of the symmetry's penalty against the data
constexpr const char* kMethods[] = {"ours", "detail", "landmarks", "rigid", "free", "soft", "copied", "pcl"};

bool pose_is_unknown(FitLevel level) {
  return level == FitLevel::anywhere || level == FitLevel::several;
}

// Those of fit(), which also finds the pose.
bool takes_several_scans(const std::string& method) {
  return method == "ours" || method == "detail" || method == "landmarks" || method == "free";
}

// The scan without what is far from the template as it was found.
PointCloud own_scan(const FitCase& each, const Similarity& pose, const RunContext& context) {
  constexpr double kNear = 0.12;  // of the diagonal, as in the fit
  const Mesh& mesh = each.model.mesh;
  return points_near(SurfaceIndex(mesh), diagonal(mesh.vertices), each.scan, pose, kNear, context);
}

// The scan and its images under the known groups of the whole shape, which stands there.
PointCloud copied_scan(const FitCase& each, const PointCloud& scan, const Similarity& pose) {
  PointCloud result = scan;
  for (const Region& region : each.model.truth.regions) {
    if (static_cast<Eigen::Index>(region.faces.size()) != each.model.mesh.faces.rows()) continue;
    for (const Motion& element : region.elements) {
      const Motion there = conjugate(pose, element);
      if ((there.linear - Eigen::Matrix3d::Identity()).norm() < 1e-9) continue;
      const auto append = [&](Points& to, const Points& from) {
        const Eigen::Index rows = to.rows();
        to.conservativeResize(rows + from.rows(), 3);
        to.bottomRows(from.rows()) = (from * there.linear.transpose()).rowwise() + there.translation.transpose();
      };
      append(result.points, scan.points);
      append(result.viewpoints, scan.viewpoints);
    }
  }
  return result;
}

// Vertices far from one another, and where they truly are.
std::vector<Landmark> spread_landmarks(const FitCase& each) {
  constexpr int kLandmarks = 4;
  std::vector<Landmark> result;
  for (const int vertex : spread_vertices(each.model.mesh.vertices, kLandmarks)) {
    result.push_back({vertex, each.truth.vertices.row(vertex).transpose()});
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

FitResult fitted_by(const std::string& method, const FitInput& input, const FitOptions& options,
                    const RunContext& context) {
  if (method == "rigid") return fit_similarity(input, {options}, context);
  if (method == "soft") {
    FullSamplingOptions soft{options, FullSymmetry::soft};
    soft.weight = kSoftWeight;
    return fit_full_sampling(input, soft, context);
  }
  return fit(input, options, context);
}

// The template as it is, where PCL finds it; its size is known.
FitResult placed_by_pcl(const FitCase& each, const RunContext& context) {
  const std::optional<Similarity> pose = pcl_pose(each.model.mesh, each.scan, each.pose.scale, context);
  FitResult result;
  result.converged = pose.has_value();
  if (!pose) throw NoResultError("PCL found no pose");
  result.pose = *pose;
  result.fitted = each.model.mesh;
  result.fitted.vertices = from_template(*pose, each.model.mesh.vertices);
  result.degrees_of_freedom = 6;
  return result;
}

FittingRow measure(const FitCase& each, const char* level, const std::string& method, const FittingOptions& options,
                   RunContext& context) {
  FittingRow row;
  row.family = each.name;
  row.level = level;
  row.method = method;
  FitOptions chosen;
  chosen.align = false;
  const bool by_landmarks = method == "landmarks";
  chosen.detail = method == "detail";
  const bool symmetric = method == "ours" || chosen.detail || by_landmarks || method == "soft";
  const SymmetryAnnotation annotation = symmetric ? each.model.truth : without_symmetry(each.model);
  const double start = seconds_now();
  try {
    // All but PCL find the pose in the same way, where it is not known.
    const bool pcl = method == "pcl";
    const bool searches = takes_several_scans(method);
    Similarity pose = each.pose;
    if (pose_is_unknown(each.level) && !pcl) {
      chosen.place = searches;
      pose = Similarity{};
      if (!chosen.place) {
        const auto placements =
            find_placements(each.model.mesh, annotation, each.scan, chosen.placement, context, pose);
        if (!placements.empty()) pose = placements.front().pose;
        row.placing = seconds_now() - start;
      }
    }
    PointCloud scan = each.scan;
    if (each.level == FitLevel::anywhere && !searches && !pcl) scan = own_scan(each, pose, context);
    if (method == "copied") scan = copied_scan(each, scan, pose);
    FitInput input{each.model.mesh, annotation, scan, pose};
    for (const PointCloud& other : each.others) input.others.push_back(&other);
    if (by_landmarks) input.landmarks = spread_landmarks(each);
    const FitResult result = pcl ? placed_by_pcl(each, context) : fitted_by(method, input, chosen, context);
    row.seconds = seconds_now() - start;
    if (pcl) row.placing = row.seconds;
    row.fitted = result.converged;
    if (!result.converged) row.failure = result.stopped_because;
    row.degrees_of_freedom = result.degrees_of_freedom;
    for (const StageTime& time : result.times) {
      if (time.stage == "placement") row.placing = time.seconds;
      if (time.stage == "fit" && result.iterations_in_all > 0) row.iteration = time.seconds / result.iterations_in_all;
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
  for (const std::string& name : options.families) {
    if (std::ranges::none_of(fit_families(), [&](const FitFamily& family) { return family.name == name; })) {
      throw UsageError("--families: there is no family '" + name + "'");
    }
  }
  if (!options.json.empty()) check_output(options.json);
  RunContext context = stage_context(given, options.stages);
  std::vector<FittingRow> rows;
  for (const FitFamily& family : fit_families()) {
    if (!asked(options.families, family.name)) continue;
    for (const Level& level : kLevels) {
      if (!asked(options.levels, level.name)) continue;
      const FitCase each = fit_case(family, level.level, context, reshaped);
      for (const char* method : kMethods) {
        if (!asked(options.methods, method)) continue;
        if (method == std::string("pcl") && level.level != FitLevel::anywhere) continue;  // the pose is known
        if (level.level == FitLevel::several && !takes_several_scans(method)) continue;
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
      ->check(CLI::IsMember({"3views", "1view", "anywhere", "shapes", "several"}))
      ->type_name("LEVEL,...");
  app.add_option("--methods", options->methods, "Only these methods")
      ->delimiter(',')
      ->check(CLI::IsMember(std::vector<std::string>(std::begin(kMethods), std::end(kMethods))))
      ->type_name("METHOD,...");
  add_stage_run(app, options->stages, "poses, noise and the fit");
  app.add_option("--write", options->folder, "Write templates, scans, truths and fits into this folder")
      ->check(CLI::ExistingDirectory)
      ->type_name("FOLDER");
  app.add_option("--json", options->json, "Write rows and means to a file")->type_name("FILE");
  return [options](CommandContext& context) { return run(*options, context); };
}

}  // namespace orbifit::benchmarks

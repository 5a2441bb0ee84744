#include "orbifit/detection/detect.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "orbifit/apps/annotation_pictures.h"
#include "orbifit/apps/report.h"
#include "orbifit/detection/detect_points.h"
#include "orbifit/model/annotation_io.h"
#include "orbifit/model/errors.h"
#include "orbifit/model/mesh_io.h"
#include "orbifit/model/scan_io.h"

#include "../commands.h"
#include "../picture_options.h"
#include "files/file.h"

namespace orbifit::commands {

namespace {

struct DetectArguments {
  std::string mesh, output, preview, colour, explain;
  std::vector<double> up;
  bool points = false;
  DetectOptions options;
};

double area_fraction(const Eigen::VectorXd& areas, const std::vector<int>& faces) {
  double area = 0;
  for (const int face : faces) area += areas[face];
  return areas.sum() > 0 ? area / areas.sum() : 0;
}

nlohmann::ordered_json to_json(const SymmetryAnnotation& found, const Mesh& mesh) {
  const Eigen::VectorXd areas = face_areas(mesh);
  nlohmann::ordered_json regions = nlohmann::ordered_json::array();
  for (const Region& region : found.regions) {
    regions.push_back({{"id", region.id},
                       {"name", region.name},
                       {"group", region.group.symbol()},
                       {"faces", region.faces.size()},
                       {"area_fraction", area_fraction(areas, region.faces)},
                       {"parent", region.parent ? nlohmann::ordered_json(*region.parent) : nullptr},
                       {"residual", {{"rms", region.residual.rms}, {"max", region.residual.max}}}});
  }
  nlohmann::ordered_json patterns = nlohmann::ordered_json::array();
  for (const Pattern& pattern : found.patterns) {
    patterns.push_back({{"id", pattern.id},
                        {"name", pattern.name},
                        {"kind", to_string(pattern.kind)},
                        {"instances", pattern.instances.size()},
                        {"residual", {{"rms", pattern.residual.rms}, {"max", pattern.residual.max}}}});
  }
  return {{"tolerance", found.tolerance}, {"regions", regions}, {"patterns", patterns}};
}

std::string to_text(const SymmetryAnnotation& found, const Mesh& mesh) {
  if (found.regions.empty() && found.patterns.empty()) {
    return "No symmetry within " + short_number(100 * found.tolerance) + " % of the diagonal.\n";
  }
  const Eigen::VectorXd areas = face_areas(mesh);
  // What is left by rounding is no news here; `check` shows every digit.
  const auto percent = [](double fraction) { return short_number(fraction < 1e-12 ? 0 : 100 * fraction, 3); };
  std::string text;
  if (!found.regions.empty()) {
    TextTable table({"region", "group", "area %", "faces", "parent", "residual max %", "name"});
    for (const Region& region : found.regions) {
      table.add({std::to_string(region.id), region.group.symbol(), percent(area_fraction(areas, region.faces)),
                 std::to_string(region.faces.size()), region.parent ? std::to_string(*region.parent) : "-",
                 percent(region.residual.max), region.name});
    }
    text += table.text();
  }
  if (!found.patterns.empty()) {
    TextTable table({"pattern", "kind", "instances", "residual max %", "name"});
    for (const Pattern& pattern : found.patterns) {
      table.add({std::to_string(pattern.id), to_string(pattern.kind), std::to_string(pattern.instances.size()),
                 percent(pattern.residual.max), pattern.name});
    }
    text += (text.empty() ? "" : "\n") + table.text();
  }
  return text + "Residuals are in percent of the diagonal, " + short_number(diagonal(mesh.vertices), 6) + ".\n";
}

// Every region's colour on the faces for which it is the smallest region; clay elsewhere.
Points region_colours(const Mesh& mesh, const std::vector<Region>& regions) {
  Points colours = Points::Constant(mesh.faces.rows(), 3, 0.75);
  std::vector<const Region*> by_size;
  for (const Region& region : regions) by_size.push_back(&region);
  std::ranges::stable_sort(by_size, std::ranges::greater{}, [](const Region* region) { return region->faces.size(); });
  for (const Region* region : by_size) {
    const Eigen::RowVector3d colour = region_colour(region->id).cast<double>();
    for (const int face : region->faces) colours.row(face) = colour;
  }
  return colours;
}

void write_preview(const DetectArguments& arguments, const Mesh& mesh, const SymmetryAnnotation& found,
                   const RunContext& run) {
  constexpr int kColumns = 4;
  ViewOptions view;
  view.width = 480;
  view.height = 360;
  view.up = picture_up(arguments.up, mesh, arguments.mesh, &found);
  const std::vector<AnnotationPicture> pictures = annotation_pictures(mesh, found, view, run);
  if (lower_extension(arguments.preview) == ".png") {
    write_png(arguments.preview, contact_sheet(pictures, kColumns));
    return;
  }
  Report report;
  report.title = std::filesystem::path(arguments.mesh).filename().string();
  report.sections.push_back({count_of(static_cast<long long>(found.regions.size()), "region") + ", " +
                                 count_of(static_cast<long long>(found.patterns.size()), "pattern"),
                             "",
                             {},
                             {}});
  for (const AnnotationPicture& picture : pictures) {
    report.sections.back().pictures.push_back({encode_png(picture.image), picture.title + "\n" + picture.detail});
  }
  write_file(arguments.preview, to_html(report));
}

// One line a judgement, columns apart by tabs.
void write_explanation(const std::string& folder, const Explanation& explanation) {
  std::string text = "stage\tsubject\tverdict\treason\n";
  for (const Explanation::Note& note : explanation.notes) {
    text += note.stage + "\t" + note.subject + "\t" + (note.kept ? "kept" : "dropped") + "\t" + note.reason + "\n";
  }
  std::filesystem::create_directories(folder);
  write_file(folder + "/stages.tsv", text);
}

/// The wall-clock time of each stage, by when progress comes to the next one.
class StageTimes {
 public:
  /// Listens to the progress of the run; must outlive it.
  explicit StageTimes(RunContext& run) {
    run.on_progress = [this, next = run.on_progress](std::string_view stage, double fraction) {
      if (stages_.empty() || stages_.back().first != stage) {
        end_stage();
        stages_.emplace_back(stage, 0);
      }
      if (next) next(stage, fraction);
    };
  }

  void write(const std::string& folder) {
    end_stage();
    std::string text = "stage\tseconds\n";
    for (const auto& [stage, seconds] : stages_) text += stage + "\t" + short_number(seconds, 3) + "\n";
    write_file(folder + "/times.tsv", text);
  }

 private:
  using Clock = std::chrono::steady_clock;

  void end_stage() {
    const Clock::time_point now = Clock::now();
    if (!stages_.empty()) stages_.back().second += std::chrono::duration<double>(now - begin_).count();
    begin_ = now;
  }

  Clock::time_point begin_ = Clock::now();
  std::vector<std::pair<std::string, double>> stages_;
};

nlohmann::ordered_json points_json(const SymmetryAnnotation& found) {
  nlohmann::ordered_json regions = nlohmann::ordered_json::array();
  for (const Region& region : found.regions) {
    regions.push_back({{"id", region.id},
                       {"name", region.name},
                       {"group", region.group.symbol()},
                       {"points", region.faces.size()},
                       {"point_fraction", static_cast<double>(region.faces.size()) / found.mesh_faces},
                       {"parent", region.parent ? nlohmann::ordered_json(*region.parent) : nullptr},
                       {"residual", {{"rms", region.residual.rms}, {"max", region.residual.max}}}});
  }
  return {{"points", found.mesh_faces}, {"tolerance", found.tolerance}, {"regions", regions}};
}

std::string points_text(const SymmetryAnnotation& found) {
  const std::string tolerance = short_number(100 * found.tolerance) + " % of the diagonal.\n";
  if (found.regions.empty()) return "No symmetry within " + tolerance;
  TextTable table({"region", "group", "points", "points %", "parent", "residual rms %", "name"});
  for (const Region& region : found.regions) {
    table.add({std::to_string(region.id), region.group.symbol(), std::to_string(region.faces.size()),
               short_number(100.0 * static_cast<double>(region.faces.size()) / found.mesh_faces, 3),
               region.parent ? std::to_string(*region.parent) : "-", short_number(100 * region.residual.rms, 3),
               region.name});
  }
  return table.text() + "Judged within " + tolerance;
}

ExitCode detect_in_points(const DetectArguments& arguments, CommandContext& context) {
  if (!arguments.preview.empty() || !arguments.colour.empty()) {
    throw UsageError("--preview and --colour show surfaces; they cannot be used with --points");
  }
  const PointCloud scan = read_scan(arguments.mesh);
  if (scan.dropped > 0) {
    context.run.message(count_of(scan.dropped, "point") + " not finite, left out and not numbered");
  }
  Explanation explanation;
  DetectOptions chosen = arguments.options;
  if (!arguments.explain.empty()) chosen.explanation = &explanation;
  const SymmetryAnnotation found = detect_points(scan, chosen, context.run);
  if (!arguments.explain.empty()) write_explanation(arguments.explain, explanation);
  if (!arguments.output.empty()) write_annotation(arguments.output, found);
  print(context, context.json ? points_json(found).dump(2) + "\n" : points_text(found));
  return kDone;
}

}  // namespace

CommandBody detect(CLI::App& app) {
  const auto arguments = std::make_shared<DetectArguments>();
  DetectOptions& options = arguments->options;
  app.add_option("MESH", arguments->mesh, "Mesh whose symmetries are sought; with --points, a scan")
      ->required()
      ->type_name("FILE");
  app.add_option("-o,--output", arguments->output,
                 "Annotation to write (.json); without it the regions are only listed")
      ->type_name("FILE");
  app.add_option(
         "--tolerance", options.tolerance,
         "Largest distance between the surface and its image that still counts as symmetric, as a fraction of the "
         "diagonal of the mesh's bounding box")
      ->capture_default_str();
  app.add_flag(
      "--points", arguments->points,
      "The file is a scan (PLY, PCD, XYZ, PTS), which may have been taken from one side only. In the annotation, face "
      "numbers are then point numbers, and the numbers of vertices and of faces are both the number of points");
  app.add_option("--time-budget", options.time_budget,
                 "Stop searching after so many seconds and keep what is verified by then; 0: no limit")
      ->capture_default_str()
      ->type_name("SECONDS");
  app.add_option("--max-seconds", options.time_budget)->group("");  // what --time-budget was called
  app.add_option("--samples", options.samples,
                 "Number of surface samples on which symmetries of the whole mesh are verified")
      ->capture_default_str();
  app.add_option("--preview", arguments->preview,
                 "Pictures of all regions and patterns to write: one sheet (.png) or a page (.html)")
      ->type_name("FILE");
  app.add_option("--colour,--color", arguments->colour, "Mesh coloured by region to write (.ply)")->type_name("FILE");
  app.add_option(
         "--explain", arguments->explain,
         "Folder to write what each stage kept and dropped, for which reason, and how long it took; created if missing")
      ->type_name("DIR");
  add_up_option(app, arguments->up, "Upward direction, drawn in the preview and kept in the annotation");
  return [arguments](CommandContext& context) {
    arguments->options.validate();
    if (!arguments->up.empty()) to_direction("--up", arguments->up);
    if (!arguments->output.empty()) check_output(arguments->output, {".json"}, {arguments->mesh});
    if (!arguments->preview.empty()) check_output(arguments->preview, {".png", ".html"}, {arguments->mesh});
    if (!arguments->colour.empty()) check_output(arguments->colour, {".ply"}, {arguments->mesh});
    if (arguments->points) return detect_in_points(*arguments, context);
    const Mesh mesh = read_mesh(arguments->mesh);
    context.run.check();
    Explanation explanation;
    DetectOptions chosen = arguments->options;
    RunContext run = context.run;
    std::optional<StageTimes> times;
    if (!arguments->explain.empty()) {
      chosen.explanation = &explanation;
      times.emplace(run);
    }
    SymmetryAnnotation found = orbifit::detect(mesh, chosen, run);
    if (!arguments->up.empty()) found.up = to_direction("--up", arguments->up);
    if (times) {
      write_explanation(arguments->explain, explanation);
      times->write(arguments->explain);
    }
    // The pictures take time: stopped meanwhile, the command leaves nothing.
    if (!arguments->preview.empty()) write_preview(*arguments, mesh, found, context.run);
    if (!arguments->output.empty()) write_annotation(arguments->output, found);
    if (!arguments->colour.empty()) write_mesh(arguments->colour, mesh, region_colours(mesh, found.regions));
    print(context, context.json ? to_json(found, mesh).dump(2) + "\n" : to_text(found, mesh));
    return kDone;
  };
}

}  // namespace orbifit::commands

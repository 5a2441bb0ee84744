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
#include "orbifit/model/appearance.h"
#include "orbifit/model/errors.h"
#include "orbifit/model/mesh_io.h"
#include "orbifit/model/scan_io.h"

#include "../commands.h"
#include "../named_parts.h"
#include "../of_file.h"
#include "../picture_options.h"
#include "../region_colours.h"
#include "../region_listing.h"
#include "files/file.h"

namespace orbifit::commands {

namespace {

struct DetectArguments {
  std::string mesh, output, preview, colour, explain;
  std::vector<double> up;
  bool points = false;
  bool colours = false;
  DetectOptions options;
};

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

// The mesh's colours, with what is wrong with them as messages; nothing where they tell nothing.
std::optional<SurfaceColours> colours_of(const DetectArguments& arguments, const Mesh& mesh, const Appearance& look,
                                         const RunContext& run) {
  SurfaceColours colours(mesh, look);
  for (const std::string& problem : colours.problems()) run.message(problem);
  if (!colours.uniform()) return colours;
  run.message(arguments.mesh + " has no colours that differ: its shape alone counts");
  return std::nullopt;
}

ExitCode detect_in_points(const DetectArguments& arguments, CommandContext& context) {
  if (!arguments.preview.empty() || !arguments.colour.empty()) {
    throw UsageError("--preview and --colour show surfaces; they cannot be used with --points");
  }
  if (arguments.colours) throw UsageError("--colours are those of a mesh; it cannot be used with --points");
  const PointCloud scan = read_scan(arguments.mesh);
  if (scan.dropped > 0) {
    context.run.message(count_of(scan.dropped, "point") + " not finite, left out and not numbered");
  }
  Explanation explanation;
  DetectOptions chosen = arguments.options;
  if (!arguments.explain.empty()) chosen.explanation = &explanation;
  const SymmetryAnnotation found = of_file(arguments.mesh, [&] { return detect_points(scan, chosen, context.run); });
  if (!arguments.explain.empty()) write_explanation(arguments.explain, explanation);
  if (!arguments.output.empty()) write_annotation(arguments.output, found);
  print(context, context.json ? point_listing_json(found).dump(2) + "\n" : point_listing(found));
  return kDone;
}

void add_options(CLI::App& app, DetectArguments& arguments) {
  DetectOptions& options = arguments.options;
  app.add_option("MESH", arguments.mesh, "Mesh whose symmetries are sought; with --points, a scan")
      ->required()
      ->type_name("FILE");
  app.add_option("-o,--output", arguments.output, "Annotation to write (.json); without it the regions are only listed")
      ->type_name("FILE");
  app.add_option(
         "--tolerance", options.tolerance,
         "Largest distance between the surface and its image that still counts as symmetric, as a fraction of the "
         "diagonal of the mesh's bounding box")
      ->capture_default_str();
  app.add_flag(
      "--points", arguments.points,
      "The file is a scan (PLY, PCD, XYZ, PTS), which may have been taken from one side only. In the annotation, face "
      "numbers are then point numbers, and the numbers of vertices and of faces are both the number of points");
  app.add_flag("--colours,--colors", arguments.colours,
               "Colours count, too (of vertices, faces, materials and textures): of each symmetry only what keeps them "
               "is listed, and what they break is told");
  app.add_option("--time-budget", options.time_budget,
                 "Stop searching after so many seconds and keep what is verified by then; 0: no limit")
      ->capture_default_str()
      ->type_name("SECONDS");
  app.add_option("--max-seconds", options.time_budget)->group("");  // what --time-budget was called
  app.add_option("--samples", options.samples,
                 "Number of surface samples on which symmetries of the whole mesh are verified")
      ->capture_default_str();
  app.add_flag("--all", options.all,
               "List also what saves next to nothing beside what is listed before it: subgroups and parts whose "
               "symmetry follows from that of others. Of a scan (--points) all is listed anyway");
  app.add_option("--preview", arguments.preview,
                 "Pictures of all regions and patterns to write: one sheet (.png) or a page (.html)")
      ->type_name("FILE");
  app.add_option("--colour,--color", arguments.colour, "Mesh coloured by region to write (.ply)")->type_name("FILE");
  app.add_option(
         "--explain", arguments.explain,
         "Folder to write what each stage kept and dropped, for which reason, and how long it took; created if missing")
      ->type_name("DIR");
  add_up_option(app, arguments.up, "Upward direction, for names and the preview; kept in the annotation");
}

int run_detect(DetectArguments& arguments, CommandContext& context) {
  arguments.options.validate();
  if (!arguments.up.empty()) to_direction("--up", arguments.up);
  if (!arguments.output.empty()) check_output(arguments.output, {".json"}, {arguments.mesh});
  if (!arguments.preview.empty()) check_output(arguments.preview, {".png", ".html"}, {arguments.mesh});
  if (!arguments.colour.empty()) check_output(arguments.colour, {".ply"}, {arguments.mesh});
  if (arguments.points) return detect_in_points(arguments, context);
  const Mesh mesh = read_mesh(arguments.mesh);
  context.run.check();
  Explanation explanation;
  DetectOptions chosen = arguments.options;
  chosen.up = picture_up(arguments.up, mesh, arguments.mesh, nullptr);
  const Appearance look =
      arguments.colours ? read_appearance(arguments.mesh, mesh) : look_if_readable(arguments.mesh, mesh);
  chosen.named_parts = named_parts(look);
  RunContext run = context.run;
  std::optional<StageTimes> times;
  if (!arguments.explain.empty()) {
    chosen.explanation = &explanation;
    times.emplace(run);
  }
  std::optional<SurfaceColours> colours;
  if (arguments.colours) colours = colours_of(arguments, mesh, look, context.run);
  std::vector<BrokenByColours> broken;
  chosen.broken_by_colours = &broken;
  if (colours) chosen.colours = &*colours;
  SymmetryAnnotation found = of_file(arguments.mesh, [&] { return orbifit::detect(mesh, chosen, run); });
  if (!arguments.up.empty()) found.up = to_direction("--up", arguments.up);
  if (times) {
    write_explanation(arguments.explain, explanation);
    times->write(arguments.explain);
  }
  // The pictures take time: stopped meanwhile, the command leaves nothing.
  if (!arguments.preview.empty()) write_preview(arguments, mesh, found, context.run);
  if (!arguments.output.empty()) write_file(arguments.output, annotation_text(found, broken));
  if (!arguments.colour.empty()) write_mesh(arguments.colour, mesh, region_face_colours(mesh, found.regions));
  print(context, context.json ? listing_json(found, broken, mesh).dump(2) + "\n" : listing(found, broken, mesh));
  return kDone;
}

}  // namespace

CommandBody detect(CLI::App& app) {
  const auto arguments = std::make_shared<DetectArguments>();
  add_options(app, *arguments);
  return [arguments](CommandContext& context) { return run_detect(*arguments, context); };
}

}  // namespace orbifit::commands

#include "orbifit/apps/render.h"

#include <filesystem>
#include <memory>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "orbifit/apps/annotation_pictures.h"
#include "orbifit/model/annotation_io.h"
#include "orbifit/model/errors.h"
#include "orbifit/model/mesh_io.h"
#include "orbifit/model/scan_io.h"

#include "../commands.h"
#include "../picture_options.h"

namespace orbifit::commands {

namespace {

constexpr int kColumns = 4;  // of several pictures

struct RenderArguments {
  std::string mesh, output, annotation, points, compare;
  int region = 0;
  bool edges = false;
  std::vector<double> up;
  ViewOptions view;
};

// The annotation, or what of it was asked for.
SymmetryAnnotation asked_annotation(const RenderArguments& arguments, const Mesh& mesh, bool one_region) {
  SymmetryAnnotation annotation = read_annotation(arguments.annotation, mesh);
  if (!one_region) return annotation;
  require_region("--region", arguments.region, annotation);
  std::erase_if(annotation.regions, [&](const Region& region) { return region.id != arguments.region; });
  annotation.patterns.clear();
  return annotation;
}

std::string file_name(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

void add_options(CLI::App& app, RenderArguments& arguments) {
  ViewOptions& view = arguments.view;
  app.add_option("MESH", arguments.mesh, "Mesh to draw")->required()->type_name("FILE");
  app.add_option("-o,--output", arguments.output, "Picture to write (.png)")->required()->type_name("FILE");
  app.add_option("--annotation", arguments.annotation,
                 "Annotation whose regions and patterns are drawn, one picture each")
      ->type_name("FILE");
  app.add_option("--region", arguments.region, "Only the region of this id")->type_name("ID");
  app.add_option("--points", arguments.points, "Scan to draw over the mesh")->type_name("FILE");
  app.add_option("--compare", arguments.compare, "Second mesh, drawn beside the first at the same scale")
      ->type_name("FILE");
  app.add_flag("--edges", arguments.edges, "Draw the edges of the triangles");
  add_up_option(app, arguments.up, "Upward direction");
  app.add_option("--azimuth", view.azimuth, "Direction of view, degrees about the upward direction")
      ->capture_default_str();
  app.add_option("--elevation", view.elevation, "Height of the camera, degrees above the horizon")
      ->capture_default_str();
  app.add_option("--width", view.width, "Width of one picture, pixels (480 if there are several)")
      ->capture_default_str()
      ->check(CLI::Range(16, 8192));
  app.add_option("--height", view.height, "Height of one picture, pixels (360 if there are several)")
      ->capture_default_str()
      ->check(CLI::Range(16, 8192));
}

int run_render(const CLI::App& app, RenderArguments& arguments, CommandContext& context) {
  const bool one_region = app.count("--region") > 0;
  if (one_region && arguments.annotation.empty()) throw UsageError("--region needs --annotation");
  if (!arguments.up.empty()) to_direction("--up", arguments.up);
  check_output(arguments.output, {".png"}, {arguments.mesh});
  const Mesh mesh = read_mesh(arguments.mesh);
  SymmetryAnnotation annotation;
  if (!arguments.annotation.empty()) annotation = asked_annotation(arguments, mesh, one_region);
  const std::size_t annotated = annotation.regions.size() + annotation.patterns.size();
  ViewOptions& chosen = arguments.view;
  chosen.up = picture_up(arguments.up, mesh, arguments.mesh, &annotation);
  if (annotated + (arguments.compare.empty() ? 0 : 1) > 1) {
    if (app.count("--width") == 0) chosen.width = 480;
    if (app.count("--height") == 0) chosen.height = 360;
  }
  PointLayer points;
  if (!arguments.points.empty()) points.points = read_scan(arguments.points).points;
  const auto decorate = [&](Scene& scene) {
    if (points.points.rows() > 0) scene.points.push_back(points);
    for (SurfaceLayer& layer : scene.surfaces) layer.edges = layer.edges || arguments.edges;
  };
  std::vector<AnnotationPicture> pictures;
  const auto add_plain = [&](const Mesh& shape, const std::string& title) {
    Scene scene;
    scene.surfaces.emplace_back().mesh = shape;
    decorate(scene);
    pictures.push_back({orbifit::render(scene, chosen, context.run), title, ""});
  };
  Mesh other;
  if (!arguments.compare.empty()) {
    other = read_mesh(arguments.compare);
    chosen.frame.resize(mesh.vertices.rows() + other.vertices.rows(), 3);
    chosen.frame << mesh.vertices, other.vertices;
  }
  if (annotated > 0) pictures = annotation_pictures(mesh, annotation, chosen, context.run, decorate);
  if (pictures.empty()) add_plain(mesh, file_name(arguments.mesh));
  if (!arguments.compare.empty()) add_plain(other, file_name(arguments.compare));
  const Image picture = pictures.size() == 1 ? pictures.front().image : contact_sheet(pictures, kColumns);
  context.run.check();
  write_png(arguments.output, picture);
  if (context.json) {
    const nlohmann::ordered_json summary{
        {"picture", arguments.output}, {"width", picture.width}, {"height", picture.height}};
    print(context, summary.dump(2) + "\n");
  } else {
    print(context, arguments.output + ": " + std::to_string(picture.width) + " x " + std::to_string(picture.height) +
                       " pixels\n");
  }
  return kDone;
}

}  // namespace

CommandBody render(CLI::App& app) {
  const auto arguments = std::make_shared<RenderArguments>();
  add_options(app, *arguments);
  return [arguments, &app](CommandContext& context) { return run_render(app, *arguments, context); };
}

}  // namespace orbifit::commands

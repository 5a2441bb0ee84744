#include "orbifit/apps/render.h"

#include <algorithm>
#include <memory>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "orbifit/model/annotation_io.h"
#include "orbifit/model/errors.h"
#include "orbifit/model/mesh_io.h"
#include "orbifit/model/scan_io.h"

#include "../commands.h"

namespace orbifit::commands {

namespace {

struct RenderArguments {
  std::string mesh, output, annotation, points, compare;
  int region = 0;
  bool edges = false;
  std::vector<double> up{0, 0, 1};
  ViewOptions view;
};

// Every region on its own, or the one that was asked for.
std::vector<Scene> annotated_scenes(const RenderArguments& arguments, const Mesh& mesh, bool one_region,
                                    const RunContext& run, std::vector<std::string>& captions) {
  const SymmetryAnnotation annotation = read_annotation(arguments.annotation, mesh);
  std::vector<Scene> scenes;
  const auto add = [&](Scene scene, const std::string& caption) {
    scenes.push_back(std::move(scene));
    captions.push_back(caption);
  };
  for (const Region& region : annotation.regions) {
    if (one_region && region.id != arguments.region) continue;
    add(visible_region_scene(mesh, region, arguments.view, run),
        std::to_string(region.id) + ": " + region.group.symbol() + " " + region.name);
  }
  if (one_region && scenes.empty()) {
    throw UsageError("--region is " + std::to_string(arguments.region) + ": " + arguments.annotation +
                     " has no such region");
  }
  for (const Pattern& pattern : annotation.patterns) {
    if (!one_region)
      add(visible_pattern_scene(mesh, pattern, arguments.view, run), to_string(pattern.kind) + " " + pattern.name);
  }
  return scenes;
}

Scene plain_scene(const Mesh& mesh) {
  Scene scene;
  scene.surfaces.emplace_back().mesh = mesh;
  return scene;
}

}  // namespace

CommandBody render(CLI::App& app) {
  const auto arguments = std::make_shared<RenderArguments>();
  ViewOptions& view = arguments->view;
  app.add_option("MESH", arguments->mesh, "Mesh to draw")->required()->type_name("FILE");
  app.add_option("-o,--output", arguments->output, "Picture to write (.png)")->required()->type_name("FILE");
  app.add_option("--annotation", arguments->annotation,
                 "Annotation whose regions and patterns are drawn, one picture each")
      ->type_name("FILE");
  app.add_option("--region", arguments->region, "Only the region of this id")->type_name("ID");
  app.add_option("--points", arguments->points, "Scan to draw over the mesh")->type_name("FILE");
  app.add_option("--compare", arguments->compare, "Second mesh, drawn beside the first at the same scale")
      ->type_name("FILE");
  app.add_flag("--edges", arguments->edges, "Draw the edges of the triangles");
  app.add_option("--up", arguments->up, "Upward direction")
      ->type_size(3)
      ->expected(1)
      ->type_name("X Y Z")
      ->default_str("0 0 1");
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
  return [arguments, &app](CommandContext& context) {
    const bool one_region = app.count("--region") > 0;
    if (one_region && arguments->annotation.empty()) throw UsageError("--region needs --annotation");
    arguments->view.up = to_direction("--up", arguments->up);
    check_output(arguments->output, {".png"}, {arguments->mesh});
    const Mesh mesh = read_mesh(arguments->mesh);
    std::vector<std::string> captions;
    std::vector<Scene> scenes;
    if (!arguments->annotation.empty()) scenes = annotated_scenes(*arguments, mesh, one_region, context.run, captions);
    if (scenes.empty()) {
      scenes.push_back(plain_scene(mesh));
      captions.push_back(arguments->mesh);
    }
    Points frame = mesh.vertices;
    if (!arguments->points.empty()) {
      const PointCloud scan = read_scan(arguments->points);
      for (Scene& scene : scenes) scene.points.emplace_back().points = scan.points;
    }
    if (!arguments->compare.empty()) {
      const Mesh other = read_mesh(arguments->compare);
      scenes.push_back(plain_scene(other));
      captions.push_back(arguments->compare);
      frame.conservativeResize(mesh.vertices.rows() + other.vertices.rows(), 3);
      frame.bottomRows(other.vertices.rows()) = other.vertices;
    }
    for (Scene& scene : scenes) {
      for (SurfaceLayer& layer : scene.surfaces) layer.edges = layer.edges || arguments->edges;
    }
    if (scenes.size() > 1) {
      arguments->view.frame = frame;
      if (app.count("--width") == 0) arguments->view.width = 480;
      if (app.count("--height") == 0) arguments->view.height = 360;
    }
    std::vector<Image> images;
    for (const Scene& scene : scenes) {
      context.run.progress("render", static_cast<double>(images.size()) / static_cast<double>(scenes.size()));
      images.push_back(orbifit::render(scene, arguments->view, context.run));
    }
    const int columns = std::min<int>(static_cast<int>(images.size()), 4);
    const Image picture = images.size() == 1 ? images.front() : contact_sheet(images, captions, columns);
    context.run.check();
    write_png(arguments->output, picture);
    if (context.json) {
      const nlohmann::ordered_json summary{
          {"picture", arguments->output}, {"width", picture.width}, {"height", picture.height}};
      print(summary.dump(2) + "\n");
    } else {
      print(arguments->output + ": " + std::to_string(picture.width) + " x " + std::to_string(picture.height) +
            " pixels\n");
    }
    return kDone;
  };
}

}  // namespace orbifit::commands

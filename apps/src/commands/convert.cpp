#include <algorithm>
#include <array>
#include <memory>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "orbifit/model/appearance.h"
#include "orbifit/model/errors.h"
#include "orbifit/model/mesh_io.h"
#include "orbifit/model/scan_io.h"

#include "../commands.h"
#include "../exports/convert_annotation.h"
#include "files/file.h"

namespace orbifit::commands {

namespace {

constexpr std::array<std::string_view, 3> kScanEndings{".pcd", ".xyz", ".pts"};

struct ConvertArguments {
  std::string input, output;
  bool points = false;
  AnnotationConversion annotation;
};

bool is_scan_file(const std::string& file) {
  return std::ranges::find(kScanEndings, lower_extension(file)) != kScanEndings.end();
}

}  // namespace

CommandBody convert(CLI::App& app) {
  const auto arguments = std::make_shared<ConvertArguments>();
  app.add_option("IN", arguments->input,
                 "Mesh (.obj, .off, .ply, .stl, .gltf, .glb, .3mf), scan (.ply, .pcd, .xyz, .pts), or with --mesh an "
                 "annotation")
      ->required()
      ->type_name("FILE");
  app.add_option("OUT", arguments->output,
                 "Mesh (.obj, .off, .ply, .stl, .glb), scan (.ply, .pcd, .xyz, .pts), or what --mesh names")
      ->required()
      ->type_name("FILE");
  app.add_flag("--points", arguments->points,
               "Keep the points only; understood where one of the files is a .pcd, .xyz or .pts");
  AnnotationConversion& annotation = arguments->annotation;
  app.add_option(
         "--mesh", annotation.mesh,
         "Of the annotation IN, or of an object of BOP's models_info.json: OUT is then a .csv or .npz of vertex "
         "correspondences, a .json of the other of these two formats, a .glb, or a .ply with the regions as quality")
      ->type_name("FILE");
  app.add_option("--region", annotation.region, "Id of the region whose vertices correspond; the first by default")
      ->type_name("ID");
  app.add_option("--element", annotation.elements, "Only this of its elements, counted from 0; may be repeated")
      ->type_name("N");
  app.add_flag("--orbits", annotation.orbits, "Write each vertex' orbit to the .csv instead of its images");
  app.add_option("--as", annotation.style,
                 "The .glb's content: regions (vertex attributes, and empties for planes and axes) or instances "
                 "(congruent parts as one mesh)")
      ->type_name("regions|instances");
  return [arguments](CommandContext& context) -> int {
    if (!arguments->annotation.mesh.empty()) {
      arguments->annotation.input = arguments->input;
      arguments->annotation.output = arguments->output;
      check_conversion(arguments->annotation);
      return convert_annotation(arguments->annotation, context);
    }
    if (lower_extension(arguments->input) == ".json") throw UsageError("an annotation needs its --mesh");
    const bool as_scan = arguments->points || is_scan_file(arguments->input) || is_scan_file(arguments->output);
    check_output(arguments->output, as_scan ? std::vector<std::string>{".ply", ".pcd", ".xyz", ".pts"}
                                            : std::vector<std::string>{".obj", ".off", ".ply", ".stl", ".glb"});
    nlohmann::ordered_json summary{{"output", arguments->output}};
    std::string text = arguments->output + ": ";
    if (as_scan) {
      const PointCloud scan = read_scan(arguments->input);
      context.run.check();
      write_scan(arguments->output, scan);
      summary["points"] = scan.points.rows();
      summary["dropped"] = scan.dropped;
      text += count_of(scan.points.rows(), "point");
      if (scan.dropped > 0) text += " (" + std::to_string(scan.dropped) + " left out: not finite)";
    } else {
      const Mesh mesh = read_mesh(arguments->input);
      const Appearance look = read_appearance(arguments->input, mesh);
      context.run.check();
      write_with_look(arguments->output, mesh, look, context.run);
      summary["vertices"] = mesh.vertices.rows();
      summary["faces"] = mesh.faces.rows();
      text += count_of(mesh.vertices.rows(), "vertex", "vertices") + ", " + count_of(mesh.faces.rows(), "triangle");
    }
    print(context, (context.json ? summary.dump(2) : text) + "\n");
    return kDone;
  };
}

}  // namespace orbifit::commands

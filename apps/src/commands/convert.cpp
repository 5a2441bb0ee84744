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
#include "files/file.h"

namespace orbifit::commands {

namespace {

constexpr std::array<std::string_view, 3> kScanEndings{".pcd", ".xyz", ".pts"};

struct ConvertArguments {
  std::string input, output;
  bool points = false;
};

bool is_scan_file(const std::string& file) {
  return std::ranges::find(kScanEndings, lower_extension(file)) != kScanEndings.end();
}

}  // namespace

CommandBody convert(CLI::App& app) {
  const auto arguments = std::make_shared<ConvertArguments>();
  app.add_option("IN", arguments->input, "Mesh (.obj, .off, .ply, .stl, .gltf, .glb) or scan (.ply, .pcd, .xyz, .pts)")
      ->required()
      ->type_name("FILE");
  app.add_option("OUT", arguments->output, "Mesh (.obj, .off, .ply, .stl, .glb) or scan (.ply, .pcd, .xyz, .pts)")
      ->required()
      ->type_name("FILE");
  app.add_flag("--points", arguments->points,
               "Keep the points only; understood where one of the files is a .pcd, .xyz or .pts");
  return [arguments](CommandContext& context) {
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

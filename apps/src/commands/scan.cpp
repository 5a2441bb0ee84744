#include <memory>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "orbifit/datasets_tools/virtual_scan.h"
#include "orbifit/model/mesh_io.h"
#include "orbifit/model/scan_io.h"

#include "../commands.h"

namespace orbifit::commands {

namespace {

struct ScanArguments {
  std::string mesh, output;
  std::vector<double> up{0, 0, 1};
  ScanOptions options;
};

}  // namespace

CommandBody scan(CLI::App& app) {
  const auto arguments = std::make_shared<ScanArguments>();
  ScanOptions& options = arguments->options;
  app.add_option("MESH", arguments->mesh, "Mesh to scan")->required()->type_name("FILE");
  app.add_option("-o,--output", arguments->output, "Scan to write: .ply, .pcd, .xyz or .pts")
      ->required()
      ->type_name("FILE");
  const auto number = [&](const std::string& name, auto& value, const std::string& meaning) {
    app.add_option(name, value, meaning)->capture_default_str();
  };
  number("--views", options.views, "Number of views, spread evenly around the mesh");
  number("--azimuth", options.azimuth, "Azimuth of the first view, degrees about the upward direction");
  number("--elevation", options.elevation, "Elevation of the camera, degrees above the horizon");
  number("--noise", options.noise,
         "Standard deviation of the depth noise along the ray, as a fraction of the diagonal");
  number("--outliers", options.outliers, "Fraction of points replaced by uniformly random points of the bounding box");
  number("--clutter", options.clutter, "Fraction of points that lie on a floor and on blocks around the mesh");
  number("--distance", options.distance, "Distance of the camera from the centre, in diagonals");
  number("--width", options.width, "Width of the depth image, pixels");
  number("--height", options.height, "Height of the depth image, pixels");
  number("--field-of-view", options.field_of_view, "Vertical field of view, degrees");
  number("--grazing-limit", options.grazing_limit, "Angle between ray and normal above which nothing is seen, degrees");
  app.add_option("--up", arguments->up, "Upward direction")
      ->type_size(3)
      ->expected(1)
      ->type_name("X Y Z")
      ->default_str("0 0 1");
  return [arguments](CommandContext& context) {
    arguments->options.up = to_direction("--up", arguments->up);
    arguments->options.validate();
    check_output(arguments->output, {".ply", ".pcd", ".xyz", ".pts"}, {arguments->mesh});
    const Mesh mesh = read_mesh(arguments->mesh);
    context.run.check();
    const PointCloud points = virtual_scan(mesh, arguments->options, context.run);
    context.run.check();
    write_scan(arguments->output, points);
    const auto count = points.points.rows();
    print(context, context.json ? nlohmann::ordered_json{{"scan", arguments->output},
                                                         {"points", count},
                                                         {"views", arguments->options.views}}
                                          .dump(2) +
                                      "\n"
                                : arguments->output + ": " + count_of(count, "point") + " from " +
                                      count_of(arguments->options.views, "view") + "\n");
    return kDone;
  };
}

}  // namespace orbifit::commands

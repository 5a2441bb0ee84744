#include "fit_scans.h"

#include <cstddef>
#include <utility>

#include <CLI/CLI.hpp>

#include "orbifit/apps/scan_union.h"
#include "orbifit/fitting/depth_image.h"
#include "orbifit/fitting/fit.h"
#include "orbifit/model/errors.h"
#include "orbifit/model/motion.h"
#include "orbifit/model/scan_io.h"

#include "files/file.h"

namespace orbifit::commands {

namespace {

std::vector<const PointCloud*> pointers_to(const std::vector<PointCloud>& scans) {
  std::vector<const PointCloud*> pointers;
  for (const PointCloud& scan : scans) pointers.push_back(&scan);
  return pointers;
}

void check_depth_options(const ScanArguments& arguments, std::size_t images, std::size_t extrinsics) {
  const auto for_each = [&](const std::string& option, std::size_t count) {
    if (count > 0 && count != images) {
      throw UsageError(std::to_string(count) + " given by " + option + " for " +
                       count_of(static_cast<long long>(images), "depth image") + ": must be one for each");
    }
  };
  if (images > 0 && arguments.intrinsics.empty()) {
    throw UsageError("a depth image needs --intrinsics fx,fy,cx,cy of its camera, in pixels");
  }
  if (images == 0 && !arguments.intrinsics.empty()) {
    throw UsageError("--intrinsics is of depth images, and no scan is a PNG of 16 bits");
  }
  for_each("--mask", arguments.masks.size());
  for_each("--extrinsics", extrinsics);
}

}  // namespace

void add_scan_options(CLI::App& app, ScanArguments& arguments) {
  app.add_option("SCAN", arguments.files,
                 "Points to fit it to, in any position and at any scale; several scans of one object, each in any "
                 "position; or depth images (PNG of 16 bits)")
      ->required();
  app.add_option(
         "--viewpoint", arguments.viewpoint,
         "Point from which all of the scan was taken, if its file does not say; 0 0 0 for a scan in the camera's frame")
      ->expected(3)
      ->type_name("X Y Z");
  app.add_flag("--one-frame", arguments.one_frame, "Several scans are in one frame, where they make up one scan");
  app.add_option("--intrinsics", arguments.intrinsics,
                 "Focal lengths and principal point of the depth images' camera, pixels")
      ->delimiter(',')
      ->expected(4)
      ->type_name("FX,FY,CX,CY");
  app.add_option("--depth-scale", arguments.depth_scale,
                 "Length of one unit of depth: 0.001 makes metres of millimetres")
      ->capture_default_str();
  app.add_option("--mask", arguments.masks,
                 "Image that is 0 where its depth image does not show the object (.png); once for each")
      ->allow_extra_args(false)
      ->type_name("FILE");
  app.add_option("--extrinsics", arguments.extrinsics,
                 "Where the camera was for each depth image (.json); then they are in one frame")
      ->type_name("FILE");
}

std::vector<PointCloud> read_scans(const ScanArguments& arguments, bool one_frame, const CommandContext& context) {
  std::vector<char> depth;
  std::size_t images = 0;
  for (const std::string& file : arguments.files) {
    depth.push_back(is_depth_image(file) ? 1 : 0);
    images += depth.back() != 0 ? 1U : 0U;
  }
  const std::vector<Motion> cameras =
      arguments.extrinsics.empty() ? std::vector<Motion>{} : read_extrinsics(arguments.extrinsics);
  check_depth_options(arguments, images, cameras.size());
  DepthCamera camera;
  if (images > 0) {
    const std::vector<double>& numbers = arguments.intrinsics;
    camera = {numbers[0], numbers[1], numbers[2], numbers[3], arguments.depth_scale, Motion{}};
  }
  std::vector<PointCloud> scans;
  std::size_t image = 0;
  for (std::size_t i = 0; i < arguments.files.size(); ++i) {
    const std::string& file = arguments.files[i];
    if (depth[i] != 0) {
      if (!cameras.empty()) camera.pose = cameras[image];
      scans.push_back(read_depth_image(file, camera, arguments.masks.empty() ? "" : arguments.masks[image]));
      ++image;
    } else {
      scans.push_back(read_scan(file));
    }
    PointCloud& scan = scans.back();
    if (!arguments.viewpoint.empty()) scan.viewpoints = to_point("--viewpoint", arguments.viewpoint).transpose();
    if (scan.dropped > 0) {
      context.run.message(file + ": left out " + count_of(scan.dropped, "point") + " that are not finite");
    }
  }
  const std::vector<std::string>& files = arguments.files;
  if (!one_frame && !arguments.one_frame && cameras.empty()) {
    for (std::size_t i = 0; i < scans.size(); ++i) check_scan(scans[i], files[i]);
    return scans;
  }
  PointCloud all = scan_union(pointers_to(scans));
  check_scan(all, files.size() == 1 ? files.front() : "");
  return {std::move(all)};
}

PointCloud joined_scans(const std::vector<PointCloud>& scans, const FitResult& result) {
  return scan_union(pointers_to(scans), result.others, result.other_used);
}

}  // namespace orbifit::commands

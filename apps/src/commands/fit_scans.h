#pragma once

#include <string>
#include <vector>

#include "orbifit/fitting/fit.h"
#include "orbifit/model/mesh.h"

#include "../command.h"

namespace CLI {
class App;
}

namespace orbifit::commands {

/// What the command line says of the scans.
struct ScanArguments {
  std::vector<std::string> files;
  std::vector<double> viewpoint;
  std::vector<double> intrinsics;  ///< fx, fy, cx, cy
  double depth_scale = 0.001;
  std::vector<std::string> masks;
  std::string extrinsics;
  bool one_frame = false;
};

void add_scan_options(CLI::App& app, ScanArguments& arguments);

/// All scans, each in its own frame but where they have one: then they are one scan.
/// \param one_frame  whatever the arguments say
/// \throw UsageError for options that do not go together, InputError as the readers
std::vector<PointCloud> read_scans(const ScanArguments& arguments, bool one_frame, const CommandContext& context);

/// All points of all scans in the frame of the first, as a fit has found it: those of scans that took part.
PointCloud joined_scans(const std::vector<PointCloud>& scans, const FitResult& result);

}  // namespace orbifit::commands

#pragma once

#include <vector>

#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

#include "base/random.h"
#include "geometry/sampling.h"
#include "placement/template_field.h"
#include "registration/correspondences.h"
#include "scan/scan_preparation.h"
#include "scan/seen_surface.h"

namespace orbifit {

/// A template and a scan, with what it takes to judge poses fast.
struct PlacementData {
  /// \param template_surface  kept by reference
  PlacementData(const MatchSurface& template_surface, const PointCloud& cloud, PreparedScan prepared,
                const RunContext& context);
  PlacementData(const PlacementData&) = delete;
  PlacementData& operator=(const PlacementData&) = delete;

  const MatchSurface& surface;
  double size;  ///< the template's diagonal, mesh units
  SurfaceSamples samples;
  TemplateField field;
  PreparedScan scan;
  double extent;  ///< of the scan without what is far out, scan units
  SeenSurface seen;
  std::vector<int> order;  ///< of the scan's points, every beginning of it is spread over the scan

 private:
  PlacementData(const MatchSurface& template_surface, const PointCloud& cloud, PreparedScan prepared,
                const RunContext& context, Random random);
};

}  // namespace orbifit

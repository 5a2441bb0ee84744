#pragma once

#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

#include "scan/scan_preparation.h"
#include "solver/silhouette_pulls.h"
#include "symmetry/moving_surface.h"

namespace orbifit {

/// What a fit's iterations need of a template and a scan, whatever the deformation and the start: computed once.
struct ScanViews {
  /// \param surface  of the mesh \param cloud  all of the scan \param scan  the points that are matched
  ScanViews(const Mesh& mesh, const MovingSurface& surface, const PointCloud& cloud, const PreparedScan& scan,
            const RunContext& context);

  bool signed_normals;  ///< the scan's normals and the faces both look outwards
  SilhouettePulls silhouette;
};

}  // namespace orbifit

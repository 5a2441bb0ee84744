#include "solver/scan_views.h"

#include "solver/outward_faces.h"

namespace orbifit {

ScanViews::ScanViews(const Mesh& mesh, const MovingSurface& surface, const PointCloud& cloud, const PreparedScan& scan,
                     const RunContext& context)
    : signed_normals(scan.normals_oriented && faces_outwards(mesh, surface, context)),
      silhouette(mesh, cloud, scan, context) {}

}  // namespace orbifit

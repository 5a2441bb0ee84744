#include "scan_views.h"

#include "orbifit/model/random.h"
#include "orbifit/model/sampling.h"
#include "orbifit/model/surface_index.h"

namespace orbifit {

namespace {

// Whether the faces look outwards, so that a scan's oriented normals must agree with theirs in sign: a ray into the
// body meets its far side from within.
bool faces_outwards(const Mesh& mesh, const RunContext& context) {
  constexpr int kSamples = 400;
  constexpr double kNearlyAll = 0.85;
  Random random(context.seed, "outwards");
  const SurfaceSamples samples = sample_surface(mesh, kSamples, random);
  const SurfaceIndex surface(mesh);
  const Points normals = face_normals(mesh);
  const double start = 1e-5 * diagonal(mesh.vertices);
  int outwards = 0;
  for (Eigen::Index i = 0; i < samples.points.rows(); ++i) {
    const Eigen::Vector3d inwards = -samples.normals.row(i);
    const auto hit = surface.cast(samples.points.row(i), inwards, start);
    if (hit && normals.row(hit->face).dot(inwards) > 0) ++outwards;
  }
  return outwards >= kNearlyAll * static_cast<double>(samples.points.rows());
}

}  // namespace

ScanViews::ScanViews(const Mesh& mesh, const PointCloud& cloud, const PreparedScan& scan, const RunContext& context)
    : signed_normals(scan.normals_oriented && faces_outwards(mesh, context)), silhouette(mesh, cloud, scan, context) {}

}  // namespace orbifit

#include "placed_scan.h"

#include <cmath>

#include "orbifit/fitting/alignment.h"
#include "orbifit/fitting/clutter.h"
#include "orbifit/model/point_index.h"
#include "orbifit/model/random.h"
#include "orbifit/model/surface_index.h"

namespace orbifit {

namespace {

// Whether a placement says that the scan is about where it was said to be, in the template's units: then its scale is
// that of the shapes, which differ, and not of the units.
bool near_given(const Mesh& mesh, const Similarity& found, const Similarity& given) {
  constexpr double kTurn = 0.3;     // radians
  constexpr double kOffset = 0.15;  // of the diagonal
  constexpr double kScale = 0.35;   // of its logarithm
  const Eigen::Vector3d centre = bounding_box_centre(mesh.vertices);
  return std::abs(std::log(found.scale / given.scale)) < kScale &&
         axis_angle(found.linear * given.linear.transpose()).angle < kTurn &&
         (found(centre) - given(centre)).norm() < kOffset * given.scale * diagonal(mesh.vertices);
}

// The share of the scan's points that stand where points were kept; planes that were taken out leave none.
double share_near(const PointCloud& cloud, const PreparedScan& kept, const RunContext& context) {
  constexpr std::uint64_t kLooks = 4000;
  const PointIndex index(kept.points);
  Random random(context.seed, "share of a scan");
  int near = 0;
  for (std::uint64_t i = 0; i < kLooks; ++i) {
    const auto row = static_cast<Eigen::Index>(random.below(static_cast<std::uint64_t>(cloud.points.rows())));
    near += index.nearest(cloud.points.row(row), 1).front().distance <= 2 * kept.spacing ? 1 : 0;
  }
  return near / static_cast<double>(kLooks);
}

}  // namespace

std::optional<PlacedScan> placed_scan(const Mesh& mesh, const PointCloud& cloud, const Similarity& pose,
                                      const Similarity& given, const PlacementOptions& options,
                                      const ScanPreparationOptions& preparation, const RunContext& context) {
  constexpr double kNear = 0.12;  // of the diagonal
  constexpr int kMore = 2;        // points, since planes among them go
  constexpr Eigen::Index kFewestNear = 10;
  const SurfaceIndex surface(mesh);
  const double size = diagonal(mesh.vertices);
  const PointCloud near = points_near(surface, size, cloud, pose, kNear, context);
  if (near.points.rows() < kFewestNear || !(diagonal(near.points) > 0)) return std::nullopt;
  ScanPreparationOptions more = preparation;
  more.most_points *= kMore;
  PlacedScan result;
  result.scan = without_planes(surface, size, prepare_scan(near, more, context), pose, options.reach, context);
  if (result.scan.points.rows() < kFewestNear) return std::nullopt;
  result.used_fraction = share_near(cloud, result.scan, context);
  result.pose = near_given(mesh, pose, given) ? align_rigidly(mesh, result.scan, given, context) : pose;
  return result;
}

}  // namespace orbifit

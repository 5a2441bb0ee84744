#include "resolution/fit_residuals.h"

#include <cmath>

#include "geometry/point_index.h"
#include "registration/alignment.h"
#include "registration/correspondences.h"

namespace orbifit {

namespace {

// How far in front of the surface a point is; negative behind it. What hardly counts is hardly far.
double offset_of(const Correspondence& pair, const Mesh& fitted, const MovingSurface& surface,
                 const Eigen::Vector3d& point) {
  const Eigen::Vector3d foot = fitted.vertices(fitted.faces.row(pair.face), Eigen::all).transpose() * pair.barycentric;
  const double side = surface.normal(pair.face).dot(pair.normal) < 0 ? -1 : 1;
  return side * std::sqrt(pair.weight) * pair.normal.dot(point - foot);
}

// Fills in what neighbours share.
void find_shared(const std::vector<Correspondence>& pairs, const std::vector<double>& offsets, const Points& points,
                 FitResiduals& residuals) {
  constexpr int kNearest = 2;  // a point itself and the next one
  const PointIndex index(points);
  double shared = 0, all = 0;
  for (const Correspondence& pair : pairs) {
    const double own = offsets[static_cast<std::size_t>(pair.scan_point)];
    all += own * own;
    for (const PointIndex::Neighbour& each : index.nearest(points.row(pair.scan_point), kNearest)) {
      if (each.index != pair.scan_point) shared += own * offsets[static_cast<std::size_t>(each.index)] / (kNearest - 1);
    }
  }
  residuals.shared = all > 0 ? shared / all : 0;
  residuals.shared_squared = shared / static_cast<double>(points.rows());
}

}  // namespace

FitResiduals fit_residuals(const FitInput& input, const PlacedScan& start, const FitResult& result,
                           const RunContext& context) {
  const PreparedScan put = with_others_moved(start, result.others);
  const Points points = to_template(result.pose, put.points);
  const Mesh fitted{to_template(result.pose, result.fitted.vertices), input.mesh.faces, {}};
  const double size = diagonal(input.mesh.vertices);
  CorrespondenceOptions options;
  options.max_distance = kLastReach * size;
  options.signed_normals = start.views->signed_normals;
  options.trim = 1;
  options.direction_noise = kDirectionNoise * size;
  options.robust_scale = kLastRobust * size;
  MovingSurface surface = moving_template(start, input.mesh);
  surface.move(fitted, context);
  const std::vector<Correspondence> pairs =
      find_correspondences(surface, points, normals_to_template(result.pose, put.normals), options, context);
  std::vector<double> offsets(static_cast<std::size_t>(points.rows()), 0);
  FitResiduals residuals;
  residuals.squared.assign(offsets.size(), kLastRobust * kLastRobust);
  for (const Correspondence& pair : pairs) {
    const auto point = static_cast<std::size_t>(pair.scan_point);
    residuals.squared[point] = robust_error(pair.distance / size, kLastRobust);
    offsets[point] = offset_of(pair, fitted, surface, points.row(pair.scan_point)) / size;
  }
  find_shared(pairs, offsets, points, residuals);
  return residuals;
}

}  // namespace orbifit

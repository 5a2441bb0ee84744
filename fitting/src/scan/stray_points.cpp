#include "scan/stray_points.h"

#include <algorithm>
#include <cmath>

#include "geometry/fitted_plane.h"

namespace orbifit {

namespace {

constexpr int kNearest = 5;        // how far the nearest are is how far the last of so many is
constexpr double kSparse = 3;      // times as far as most have them: such a point may be a stray
constexpr int kNeighbours = 16;    // of which a plane is sought
constexpr double kOffPlane = 0.3;  // of the farthest neighbour's distance: too far off their plane
constexpr double kNoPlane = 0.05;  // share of the neighbours' variance across their plane, of points in no plane

double reach_of(const PointIndex& index, const Eigen::Vector3d& point) {
  return index.nearest(point, kNearest + 1).back().distance;  // the point itself is among them
}

bool lies_on_a_surface(const Points& all, const PointIndex& index, const Eigen::Vector3d& point) {
  std::vector<int> near;
  double farthest = 0;
  for (const PointIndex::Neighbour& each : index.nearest(point, kNeighbours + 1)) {
    if (each.distance > 0) near.push_back(each.index);
    farthest = std::max(farthest, each.distance);
  }
  if (near.size() < 3) return true;  // copies of one another: nothing can be said
  const FittedPlane plane = fitted_plane(all, near);
  const Eigen::Vector3d variances = plane.deviations.cwiseAbs2();
  const double off = std::abs(plane.normal.dot(point - plane.point));
  return variances[0] <= kNoPlane * variances.sum() && off <= kOffPlane * farthest;
}

}  // namespace

std::vector<int> without_strays(const Points& points, const std::vector<int>& kept, const PointIndex& index,
                                const std::vector<int>& typical) {
  if (points.rows() <= kNeighbours || typical.empty()) return kept;
  std::vector<double> reaches;
  reaches.reserve(typical.size());
  for (const int i : typical) reaches.push_back(reach_of(index, points.row(i).transpose()));
  const auto middle = reaches.begin() + static_cast<std::ptrdiff_t>(reaches.size() / 2);
  std::nth_element(reaches.begin(), middle, reaches.end());
  const double sparse = kSparse * *middle;
  std::vector<int> result;
  for (const int i : kept) {
    const Eigen::Vector3d point = points.row(i);
    if (reach_of(index, point) <= sparse || lies_on_a_surface(points, index, point)) result.push_back(i);
  }
  return result;
}

}  // namespace orbifit

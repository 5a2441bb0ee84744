#include "scan/clutter.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "base/random.h"
#include "geometry/fitted_plane.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;

constexpr double kLikeNormal = 0.9;

std::vector<double> distances_to(const SurfaceIndex& surface, const Points& points, const Similarity& pose,
                                 double largest, const RunContext& context) {
  const Similarity back = inverse(pose);
  std::vector<double> result(static_cast<std::size_t>(points.rows()));
  parallel_for(context, result.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      result[i] = surface.nearest(back(points.row(static_cast<Eigen::Index>(i))), largest).distance;
    }
  });
  return result;
}

struct Plane {
  Vector3d point, normal;

  bool holds(const Vector3d& p, const Vector3d& n, double thickness) const {
    return std::abs(normal.dot(p - point)) <= thickness && std::abs(normal.dot(n)) >= kLikeNormal;
  }
};

}  // namespace

PointCloud points_near(const SurfaceIndex& surface, double template_diagonal, const PointCloud& scan,
                       const Similarity& pose, double reach, const RunContext& context) {
  const double largest = reach * template_diagonal;
  const std::vector<double> distances = distances_to(surface, scan.points, pose, largest, context);
  std::vector<int> kept;
  for (std::size_t i = 0; i < distances.size(); ++i) {
    if (distances[i] <= largest) kept.push_back(static_cast<int>(i));
  }
  PointCloud result;
  result.points = scan.points(kept, Eigen::all);
  if (scan.normals.rows() == scan.points.rows()) result.normals = scan.normals(kept, Eigen::all);
  result.viewpoints =
      scan.viewpoints.rows() == scan.points.rows() ? Points(scan.viewpoints(kept, Eigen::all)) : scan.viewpoints;
  return result;
}

PreparedScan without_planes(const SurfaceIndex& surface, double template_diagonal, const PreparedScan& scan,
                            const Similarity& pose, double explained, const RunContext& context) {
  constexpr int kMaxPlanes = 6;
  constexpr int kTries = 150;
  constexpr double kMin = 0.03;         // of the points, unexplained ones in the plane
  constexpr double kOfOthers = 0.65;    // of the plane's points, that the template must not explain
  constexpr double kThickness = 0.008;  // of the template's diagonal
  const double reach = explained * template_diagonal;
  const std::vector<double> distances = distances_to(surface, scan.points, pose, reach, context);
  const double thickness = kThickness * template_diagonal * pose.scale;
  std::vector<int> left(distances.size());
  for (std::size_t i = 0; i < left.size(); ++i) left[i] = static_cast<int>(i);
  const auto open = [&](int i) { return distances[static_cast<std::size_t>(i)] > reach; };
  const auto members = [&](const Plane& plane, double slack) {
    std::vector<int> result;
    std::ranges::copy_if(left, std::back_inserter(result), [&](int i) {
      return plane.holds(scan.points.row(i), scan.normals.row(i), slack * thickness);
    });
    return result;
  };
  Random random(context.seed, "planes beside a template");
  for (int round = 0; round < kMaxPlanes; ++round) {
    std::vector<int> others;
    std::ranges::copy_if(left, std::back_inserter(others), open);
    const auto least = static_cast<std::ptrdiff_t>(kMin * static_cast<double>(distances.size()));
    std::vector<int> best;
    std::ptrdiff_t most = least;
    for (int k = 0; k<kTries&& static_cast<std::ptrdiff_t>(others.size())> least; ++k) {
      const int seed = others[random.below(others.size())];
      std::vector<int> found = members({scan.points.row(seed), scan.normals.row(seed)}, 1);
      const std::ptrdiff_t unexplained = std::ranges::count_if(found, open);
      if (unexplained <= most || static_cast<double>(unexplained) < kOfOthers * static_cast<double>(found.size())) {
        continue;
      }
      most = unexplained;
      best = std::move(found);
    }
    if (best.empty()) break;
    const FittedPlane fitted = fitted_plane(scan.points, best);
    const std::vector<int> gone = members({fitted.point, fitted.normal}, 1.5);
    std::vector<int> rest;
    std::ranges::set_difference(left, gone, std::back_inserter(rest));
    left = std::move(rest);
  }
  PreparedScan result;
  result.points = scan.points(left, Eigen::all);
  result.normals = scan.normals(left, Eigen::all);
  if (scan.viewpoints.rows() == scan.points.rows()) {
    result.viewpoints = scan.viewpoints(left, Eigen::all);
  } else {
    result.viewpoints = scan.viewpoints;
  }
  result.normals_oriented = scan.normals_oriented;
  result.spacing = scan.spacing;
  result.noise = scan.noise;
  return result;
}

}  // namespace orbifit

#include "scan/point_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <string>

#include "orbifit/model/errors.h"
#include "orbifit/model/point_group.h"

#include "geometry/fitted_plane.h"
#include "geometry/grid_cell.h"
#include "geometry/point_index.h"

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr int kMinPoints = 50;

Vector3d row(const Points& points, int i) {
  return points.row(i);
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

// Per point its mean distance to the nearest others; points that coincide with others count as one.
std::vector<double> neighbour_distances(const Points& points, const PointIndex& index, int count,
                                        const RunContext& context) {
  std::vector<double> result(static_cast<std::size_t>(points.rows()));
  parallel_for(context, result.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      double sum = 0;
      for (const auto& n : index.nearest(points.row(static_cast<Eigen::Index>(i)), count + 1)) sum += n.distance;
      result[i] = sum / count;
    }
  });
  return result;
}

std::vector<char> find_outliers(const std::vector<double>& distances) {
  constexpr double kDeviations = 3;
  double sum = 0;
  double square = 0;
  for (const double d : distances) {
    sum += d;
    square += d * d;
  }
  const double count = static_cast<double>(distances.size());
  const double mean = sum / count;
  const double limit = mean + kDeviations * std::sqrt(std::max(0.0, square / count - mean * mean));
  std::vector<char> result(distances.size());
  for (std::size_t i = 0; i < distances.size(); ++i) result[i] = distances[i] > limit ? 1 : 0;
  return result;
}

// One point of each voxel, the one nearest to the mean of its points.
std::vector<int> thin(const Points& points, const std::vector<char>& outlier, double edge,
                      std::vector<int>& kept_of_point) {
  std::map<std::array<std::int64_t, 3>, std::vector<int>> voxels;
  for (int i = 0; i < points.rows(); ++i) {
    if (outlier[static_cast<std::size_t>(i)] != 0) continue;
    voxels[grid_cell(row(points, i), edge)].push_back(i);
  }
  std::vector<int> kept;
  kept_of_point.assign(static_cast<std::size_t>(points.rows()), -1);
  for (const auto& [key, members] : voxels) {
    Vector3d mean = Vector3d::Zero();
    for (const int i : members) mean += row(points, i);
    mean /= static_cast<double>(members.size());
    const int nearest =
        *std::ranges::min_element(members, {}, [&](int i) { return (row(points, i) - mean).squaredNorm(); });
    for (const int i : members) kept_of_point[static_cast<std::size_t>(i)] = static_cast<int>(kept.size());
    kept.push_back(nearest);
  }
  return kept;
}

// Planes through ever more neighbours, until these spread far enough to outweigh the noise.
std::vector<FittedPlane> fit_planes(const Points& points, const std::vector<int>& kept, const PointIndex& index,
                                    const RunContext& context) {
  constexpr double kFlat = 0.1;  // deviation across the plane to the lesser along it
  std::vector<FittedPlane> best;
  double best_ratio = std::numeric_limits<double>::infinity();
  for (const int count : {12, 24, 48, 96, 160}) {
    if (count > points.rows() / 4) break;
    std::vector<FittedPlane> planes(kept.size());
    parallel_for(context, kept.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        std::vector<int> near;
        for (const auto& n : index.nearest(points.row(kept[i]), count)) near.push_back(n.index);
        planes[i] = fitted_plane(points, near);
      }
    });
    context.check();
    std::vector<double> ratios(kept.size());
    std::ranges::transform(planes, ratios.begin(), [](const FittedPlane& p) {
      return p.deviations[1] > 0 ? p.deviations[0] / p.deviations[1] : 1;
    });
    const double ratio = median(std::move(ratios));
    if (ratio < best_ratio) {
      best_ratio = ratio;
      best = std::move(planes);
    }
    if (best_ratio < kFlat) break;
  }
  return best;
}

std::vector<std::vector<int>> find_clusters(const Points& points, const PointIndex& index, double step) {
  std::vector<std::vector<int>> result;
  std::vector<char> seen(static_cast<std::size_t>(points.rows()));
  for (int first = 0; first < points.rows(); ++first) {
    if (seen[static_cast<std::size_t>(first)] != 0) continue;
    seen[static_cast<std::size_t>(first)] = 1;
    std::vector<int> cluster{first};
    for (std::size_t i = 0; i < cluster.size(); ++i) {
      for (const auto& n : index.within(points.row(cluster[i]), step)) {
        char& known = seen[static_cast<std::size_t>(n.index)];
        if (known != 0) continue;
        known = 1;
        cluster.push_back(n.index);
      }
    }
    std::ranges::sort(cluster);
    result.push_back(std::move(cluster));
  }
  std::ranges::stable_sort(result, std::greater<>(), [](const auto& cluster) { return cluster.size(); });
  return result;
}

// Whether hardly any direction from `eye` meets the surface at two depths.
bool seen_from(const Points& points, const std::vector<double>& spacings, const Vector3d& eye) {
  constexpr double kFewAngles = 2.0;  // spacings
  constexpr double kMaxBehind = 0.05;
  double nearest = std::numeric_limits<double>::infinity();
  std::vector<double> angles;
  for (int i = 0; i < points.rows(); ++i) {
    const double distance = (row(points, i) - eye).norm();
    nearest = std::min(nearest, distance);
    angles.push_back(spacings[static_cast<std::size_t>(i)] / std::max(distance, 1e-12));
  }
  if (nearest < 0.5) return false;  // a sensor stands apart from what it sees
  const double cell = kFewAngles * median(angles);
  const Vector3d forward = (-eye).normalized();
  const Matrix3d frame = frame_about(forward);
  std::map<std::array<std::int64_t, 2>, std::array<double, 2>> depths;
  for (int i = 0; i < points.rows(); ++i) {
    const Vector3d p = frame.transpose() * (row(points, i) - eye);
    const std::array<std::int64_t, 2> key{grid_cell(p.x() / p.z() / cell), grid_cell(p.y() / p.z() / cell)};
    const auto [at, fresh] = depths.try_emplace(key, std::array<double, 2>{p.z(), p.z()});
    if (!fresh) at->second = {std::min(at->second[0], p.z()), std::max(at->second[1], p.z())};
  }
  const auto behind = std::ranges::count_if(depths, [](const auto& d) { return d.second[1] - d.second[0] > 0.1; });
  return static_cast<double>(behind) < kMaxBehind * static_cast<double>(depths.size());
}

void check_points(const PointCloud& scan) {
  if (scan.points.rows() < kMinPoints) {
    throw InputError("", "",
                     "the scan has " + std::to_string(scan.points.rows()) + " points; symmetries are looked for from " +
                         std::to_string(kMinPoints) + " on");
  }
  if (!scan.points.allFinite()) throw InputError("", "points", "a coordinate is not finite");
  if (!(diagonal(scan.points) > 0)) throw InputError("", "", "the scan has no extent");
}

struct ThinnedPoints {
  std::vector<int> kept;
  std::vector<int> kept_of_point;  // see PointSurface
  double edge = 0;                 // of the voxels
};

// By voxels that grow until at most `most` points are kept.
ThinnedPoints thin_to(int most, const Points& points, const std::vector<double>& distances) {
  const std::vector<char> outlier = find_outliers(distances);
  ThinnedPoints result;
  result.edge = std::max(median(distances), 1e-4);
  result.kept = thin(points, outlier, result.edge, result.kept_of_point);
  while (static_cast<int>(result.kept.size()) > most) {
    result.edge *= std::max(1.05, std::sqrt(static_cast<double>(result.kept.size()) / most));
    result.kept = thin(points, outlier, result.edge, result.kept_of_point);
  }
  const std::size_t count = result.kept.size();
  if (count < static_cast<std::size_t>(kMinPoints)) {
    throw InputError("", "",
                     "the scan has " + std::to_string(count) + " points at places of their own; symmetries " +
                         "are looked for from " + std::to_string(kMinPoints) + " on");
  }
  return result;
}

// Points, their feet on the planes through their neighbours, normals (the scan's where it has them), and the noise.
void set_points(const PointCloud& scan, const Points& all, const std::vector<int>& kept,
                const std::vector<FittedPlane>& planes, PointSurface& result) {
  const auto count = static_cast<Eigen::Index>(kept.size());
  std::vector<double> thicknesses;
  const bool known_normals = scan.normals.rows() == scan.points.rows();
  result.points.resize(count, 3);
  result.smooth.resize(count, 3);
  result.normals.resize(count, 3);
  for (Eigen::Index i = 0; i < count; ++i) {
    const int number = kept[static_cast<std::size_t>(i)];
    const FittedPlane& plane = planes[static_cast<std::size_t>(i)];
    result.points.row(i) = all.row(number);
    result.smooth.row(i) = all.row(number);
    result.smooth.row(i) -= plane.normal.transpose() * plane.normal.dot(row(all, number) - plane.point);
    const bool usable = known_normals && std::abs(scan.normals.row(number).norm() - 1) < 0.1;
    result.normals.row(i) = usable ? Vector3d(scan.normals.row(number).normalized()) : plane.normal;
    thicknesses.push_back(plane.deviations[0]);
  }
  result.noise = median(thicknesses);
}

}  // namespace

PointSurface prepare_points(const PointCloud& scan, int most, const RunContext& context) {
  check_points(scan);
  PointSurface result;
  const double size = diagonal(scan.points);
  const Vector3d centre = bounding_box_centre(scan.points);
  result.input_of_normalised = {size, Matrix3d::Identity(), centre};
  const Points all = (scan.points.rowwise() - centre.transpose()) / size;
  const PointIndex all_index(all);
  ThinnedPoints thinned = thin_to(most, all, neighbour_distances(all, all_index, 8, context));
  context.check();
  set_points(scan, all, thinned.kept, fit_planes(all, thinned.kept, all_index, context), result);
  result.kept_of_point = std::move(thinned.kept_of_point);
  const PointIndex index(result.points);
  // In a square grid the eight nearest are 1.2 steps away on average, among random points as dense nearly as far.
  constexpr double kMeanOfEight = 1.2;
  std::vector<double> spacings = neighbour_distances(result.points, index, 8, context);
  for (double& spacing : spacings) spacing /= kMeanOfEight;
  result.spacing = median(spacings);
  result.clusters = find_clusters(result.points, index, 4 * std::max(result.spacing, thinned.edge));
  if (scan.viewpoints.rows() == 1) {
    result.viewpoint = inverse(result.input_of_normalised)(scan.viewpoints.row(0));
  } else if (scan.viewpoints.rows() == 0) {
    const Vector3d origin = inverse(result.input_of_normalised)(Vector3d::Zero());
    if (seen_from(result.points, spacings, origin)) result.viewpoint = origin;
  }
  return result;
}

Mesh surfels(const PointSurface& surface, double radius) {
  Mesh mesh;
  mesh.vertices.resize(3 * surface.points.rows(), 3);
  mesh.faces.resize(surface.points.rows(), 3);
  for (int i = 0; i < surface.points.rows(); ++i) {
    const GroupFrame frame = frame_about(row(surface.normals, i));
    for (int k = 0; k < 3; ++k) {
      const double angle = 2 * std::numbers::pi * k / 3;
      const Vector3d corner =
          row(surface.smooth, i) + radius * (std::cos(angle) * frame.col(0) + std::sin(angle) * frame.col(1));
      mesh.vertices.row(3 * i + k) = surface.input_of_normalised(corner);
    }
    mesh.faces.row(i) << 3 * i, 3 * i + 1, 3 * i + 2;
  }
  return mesh;
}

std::vector<int> scan_points(const PointSurface& surface, const std::vector<int>& kept) {
  std::vector<int> result;
  for (std::size_t i = 0; i < surface.kept_of_point.size(); ++i) {
    if (std::ranges::binary_search(kept, surface.kept_of_point[i])) result.push_back(static_cast<int>(i));
  }
  return result;
}

}  // namespace orbifit

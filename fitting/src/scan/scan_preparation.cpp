#include "scan/scan_preparation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <string>
#include <unordered_set>
#include <vector>

#include "orbifit/fitting/fit.h"
#include "orbifit/model/errors.h"

#include "base/random.h"
#include "geometry/fitted_plane.h"
#include "geometry/point_index.h"
#include "scan/scan_normals.h"
#include "scan/stray_points.h"
#include "scan/thinned_scan.h"

namespace orbifit {

namespace {

constexpr int kMinPoints = 10;

std::vector<int> one_a_cell(const Points& points, double width) {
  const Eigen::RowVector3d corner = points.colwise().minCoeff();
  std::unordered_set<std::uint64_t> cells;
  std::vector<int> kept;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    std::uint64_t key = 0;
    for (int k = 0; k < 3; ++k) {
      const auto cell = static_cast<std::uint64_t>(std::floor((points(i, k) - corner[k]) / width));
      key = key << 21U | (cell & 0x1fffffU);
    }
    if (cells.insert(key).second) kept.push_back(static_cast<int>(i));
  }
  return kept;
}

// The width whose cells keep nearly as many points as allowed, by bisection.
std::vector<int> spread_evenly(const Points& points, int most) {
  if (points.rows() <= most) {
    std::vector<int> all(static_cast<std::size_t>(points.rows()));
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<int>(i);
    return all;
  }
  double low = diagonal(points) / (1U << 20U);
  double high = diagonal(points);
  std::vector<int> kept = one_a_cell(points, high);
  for (int round = 0; round < 40 && high > 1.02 * low; ++round) {
    const double middle = std::sqrt(low * high);
    std::vector<int> trial = one_a_cell(points, middle);
    if (static_cast<int>(trial.size()) > most) {
      low = middle;
    } else {
      high = middle;
      kept = std::move(trial);
    }
  }
  return kept;
}

// Ascending.
std::vector<int> some_of(Eigen::Index total, int most, std::uint64_t seed) {
  std::vector<int> all(static_cast<std::size_t>(total));
  std::iota(all.begin(), all.end(), 0);
  if (total <= most) return all;
  Random random(seed, "some points of a scan");
  for (int i = 0; i < most; ++i) {
    std::swap(all[static_cast<std::size_t>(i)],
              all[static_cast<std::size_t>(i) + random.below(all.size() - static_cast<std::size_t>(i))]);
  }
  all.resize(static_cast<std::size_t>(most));
  std::ranges::sort(all);
  return all;
}

// Of planes through the nearest points: on a smooth surface that is scanned finely, what the scanner adds.
double noise_of(const Points& points, const PointIndex& index, const std::vector<int>& typical, int neighbours) {
  std::vector<double> offsets;
  for (const int i : typical) {
    const std::vector<int> near = nearest_points(index, points.row(i), neighbours);
    const auto count = static_cast<double>(near.size());
    offsets.push_back(fitted_plane(points, near).deviations[0] * std::sqrt(count / std::max(1.0, count - 3)));
  }
  const auto middle = offsets.begin() + static_cast<std::ptrdiff_t>(offsets.size() / 2);
  std::nth_element(offsets.begin(), middle, offsets.end());
  return *middle;
}

}  // namespace

double median_spacing(const Points& points) {
  const PointIndex index(points);
  std::vector<double> distances;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    distances.push_back(index.nearest(points.row(i).transpose(), 2).back().distance);
  }
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return *middle;
}

void check_scan(const PointCloud& scan, const std::string& file) {
  const std::string where = file.empty() ? "scan" : "";
  const Eigen::Index count = scan.points.rows();
  if (count < kMinPoints) {
    throw InputError(file, where,
                     "has " + std::to_string(count) + (count == 1 ? " usable point" : " usable points") +
                         "; a fit needs at least " + std::to_string(kMinPoints));
  }
  if (!(diagonal(scan.points) > 0)) throw InputError(file, where, "all its points are at one place");
}

PreparedScan prepare_scan(const PointCloud& scan, const ScanPreparationOptions& options, const RunContext& context) {
  check_scan(scan);
  const int most = std::max(kScanPointsRead, options.most_points);
  if (scan.points.rows() > most) return prepare_scan(thinned(scan, most, context.seed), options, context);
  context.progress("scan", 0);
  constexpr int kPlanes = 400;
  const PointIndex index(scan.points);
  const std::vector<int> typical = some_of(scan.points.rows(), kPlanes, context.seed);
  std::vector<int> kept = options.evenly ? spread_evenly(scan.points, options.most_points)
                                         : some_of(scan.points.rows(), options.most_points, context.seed);
  kept = without_strays(scan.points, kept, index, typical);
  PreparedScan result;
  result.points = scan.points(kept, Eigen::all);
  result.spacing = median_spacing(result.points);
  result.noise = noise_of(scan.points, index, typical, options.neighbours);
  if (scan.normals.rows() == scan.points.rows()) {
    result.normals = scan.normals(kept, Eigen::all);
    result.normals_oriented = true;
  } else {
    result.normals = plane_normals(scan.points, index, kept, options.neighbours, context);
  }
  if (scan.viewpoints.rows() > 1) result.viewpoints = scan.viewpoints(kept, Eigen::all);
  if (scan.viewpoints.rows() == 1) result.viewpoints = scan.viewpoints;
  if (scan.viewpoints.rows() > 0) {
    result.normals_oriented = true;
    for (std::size_t i = 0; i < kept.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      const Eigen::RowVector3d viewpoint = scan.viewpoints.row(scan.viewpoints.rows() == 1 ? 0 : kept[i]);
      if (result.normals.row(row).dot(viewpoint - result.points.row(row)) < 0) result.normals.row(row) *= -1;
    }
  }
  context.progress("scan", 1);
  return result;
}

}  // namespace orbifit

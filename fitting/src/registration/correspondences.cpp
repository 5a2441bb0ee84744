#include "registration/correspondences.h"

#include <algorithm>
#include <cmath>

namespace orbifit {

namespace {

// The gradient of the distance to the surface: the face's normal where the foot lies within the face, but across an
// edge it points from the edge to the scan point, so that a part seen from one side alone still finds its width.
// Offsets below `noise` do not tell a direction.
Eigen::Vector3d distance_direction(const Eigen::Vector3d& offset, const Eigen::Vector3d& normal, double noise) {
  const double sign = offset.dot(normal) < 0 ? -1 : 1;
  const Eigen::Vector3d direction = sign * offset + noise * normal;
  const double length = direction.norm();
  return length > 0 ? Eigen::Vector3d(direction / length) : normal;
}

}  // namespace

double robust_error(double distance, double scale) {
  const double ratio = distance / scale;
  return distance * distance / (1 + ratio * ratio);
}

double robust_weight(double distance, double scale) {
  const double ratio = distance / scale;
  return 1 / ((1 + ratio * ratio) * (1 + ratio * ratio));
}

namespace {

// \param index  with nearest_facing() \param surface  with normal()
template <typename Index, typename Surface>
std::vector<Correspondence> correspondences(const Index& index, const Surface& surface, const Points& scan_points,
                                            const Points& scan_normals, const CorrespondenceOptions& options,
                                            const RunContext& context, std::vector<int>* likely) {
  const auto every = static_cast<std::size_t>(options.every);
  const auto count = static_cast<std::size_t>(scan_points.rows());
  std::vector<Correspondence> all((count + every - 1) / every);
  if (likely != nullptr) likely->resize(count, -1);
  parallel_for(context, all.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t point = i * every;
      const auto row = static_cast<Eigen::Index>(point);
      const auto nearest = index.nearest_facing(scan_points.row(row).transpose(), scan_normals.row(row).transpose(),
                                                options.min_normal_cosine, options.max_distance,
                                                !options.signed_normals, likely != nullptr ? (*likely)[point] : -1);
      if (likely != nullptr) (*likely)[point] = nearest.place;
      if (nearest.face < 0) continue;
      Correspondence& pair = all[i];
      pair.scan_point = static_cast<int>(point);
      pair.face = nearest.face;
      pair.barycentric = nearest.barycentric;
      pair.normal = distance_direction(scan_points.row(row).transpose() - nearest.point, surface.normal(nearest.face),
                                       options.direction_noise);
      pair.distance = nearest.distance;
      pair.weight = robust_weight(nearest.distance, options.robust_scale);
    }
  });
  std::erase_if(all, [](const Correspondence& pair) { return pair.face < 0; });
  if (all.empty()) return all;
  std::vector<double> distances;
  for (const Correspondence& pair : all) distances.push_back(pair.distance);
  const auto last = static_cast<std::ptrdiff_t>(std::ceil(options.trim * static_cast<double>(all.size()))) - 1;
  std::ranges::nth_element(distances, distances.begin() + last);
  const double limit = std::max(distances[static_cast<std::size_t>(last)], options.never_trim);
  std::erase_if(all, [&](const Correspondence& pair) { return pair.distance > limit; });
  return all;
}

}  // namespace

std::vector<Correspondence> find_correspondences(const MatchSurface& surface, const Points& scan_points,
                                                 const Points& scan_normals, const CorrespondenceOptions& options,
                                                 const RunContext& context, std::vector<int>* likely) {
  return correspondences(surface.index, surface, scan_points, scan_normals, options, context, likely);
}

std::vector<Correspondence> find_correspondences(const MovingSurface& surface, const Points& scan_points,
                                                 const Points& scan_normals, const CorrespondenceOptions& options,
                                                 const RunContext& context, std::vector<int>* likely) {
  return correspondences(surface, surface, scan_points, scan_normals, options, context, likely);
}

double weighted_rms(const std::vector<Correspondence>& correspondences) {
  double squares = 0;
  double weights = 0;
  for (const Correspondence& pair : correspondences) {
    squares += pair.weight * pair.distance * pair.distance;
    weights += pair.weight;
  }
  return weights > 0 ? std::sqrt(squares / weights) : 0;
}

double typical_distance(const std::vector<Correspondence>& correspondences) {
  constexpr double kOfMedian = 1.4826;
  if (correspondences.empty()) return 0;
  std::vector<double> distances;
  for (const Correspondence& each : correspondences) distances.push_back(each.distance);
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return kOfMedian * *middle;
}

}  // namespace orbifit

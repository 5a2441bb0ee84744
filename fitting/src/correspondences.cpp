#include "orbifit/fitting/correspondences.h"

#include <algorithm>
#include <cmath>

namespace orbifit {

std::vector<Correspondence> find_correspondences(const MatchSurface& surface, const Points& scan_points,
                                                 const Points& scan_normals, const CorrespondenceOptions& options,
                                                 const RunContext& context) {
  std::vector<Correspondence> all(static_cast<std::size_t>(scan_points.rows()));
  parallel_for(context, all.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      const auto nearest =
          surface.index.nearest_facing(scan_points.row(row).transpose(), scan_normals.row(row).transpose(),
                                       options.min_normal_cosine, options.max_distance, !options.signed_normals);
      if (nearest.face < 0) continue;
      const double ratio = nearest.distance / options.robust_scale;
      all[i] = {static_cast<int>(i), nearest.face,
                nearest.barycentric, surface.normals.row(nearest.face).transpose(),
                nearest.distance,    1 / ((1 + ratio * ratio) * (1 + ratio * ratio))};
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

double weighted_rms(const std::vector<Correspondence>& correspondences) {
  double squares = 0;
  double weights = 0;
  for (const Correspondence& pair : correspondences) {
    squares += pair.weight * pair.distance * pair.distance;
    weights += pair.weight;
  }
  return weights > 0 ? std::sqrt(squares / weights) : 0;
}

}  // namespace orbifit

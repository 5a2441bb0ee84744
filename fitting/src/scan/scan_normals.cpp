#include "scan/scan_normals.h"

#include "geometry/fitted_plane.h"

namespace orbifit {

std::vector<int> nearest_points(const PointIndex& index, const Eigen::Vector3d& place, int count) {
  std::vector<int> result;
  for (const PointIndex::Neighbour& neighbour : index.nearest(place, count)) result.push_back(neighbour.index);
  return result;
}

Points plane_normals(const Points& points, const PointIndex& index, const std::vector<int>& kept, int neighbours,
                     const RunContext& context) {
  Points normals(static_cast<Eigen::Index>(kept.size()), 3);
  parallel_for(context, kept.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::vector<int> near = nearest_points(index, points.row(kept[i]), neighbours);
      normals.row(static_cast<Eigen::Index>(i)) = fitted_plane(points, near).normal;
    }
  });
  return normals;
}

}  // namespace orbifit

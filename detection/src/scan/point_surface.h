#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"
#include "orbifit/model/run_context.h"

namespace orbifit {

/// A scan made ready for detection: thinned, with normals, moved so that its box is centred on the origin and its
/// diagonal is 1. Lengths are those of the normalised scan.
struct PointSurface {
  Points points;                           ///< #K by 3, one of the scan's points for each voxel in use
  Points normals;                          ///< #K by 3, unit, of either sign
  Points smooth;                           ///< #K by 3, the points moved onto the planes fitted to their neighbours
  std::vector<int> kept_of_point;          ///< per point of the scan: the kept point of its voxel; -1 for an outlier
  std::vector<std::vector<int>> clusters;  ///< kept points linked by steps of a few spacings, ascending; largest first
  /// From where the scan was seen, if from one place: the scan's own viewpoint, or its origin where no two points stand
  /// behind one another as seen from there.
  std::optional<Eigen::Vector3d> viewpoint;
  double spacing = 0;  ///< median step between neighbouring kept points
  double noise = 0;    ///< median distance from the planes fitted to the neighbours
  Similarity input_of_normalised;
};

/// Leaves out statistical outliers (points farther from their 8 nearest neighbours than the mean by three standard
/// deviations), takes the scan's normals or fits planes to neighbours, as many as it takes to outweigh the noise, and
/// thins.
/// \param most kept points, about
/// \throw InputError for fewer than 50 points, for points that are not finite, and when they have no extent
PointSurface prepare_points(const PointCloud& scan, int most, const RunContext& context);

/// A triangle in the tangent plane of each smoothed kept point: triangle k is kept point k's. Scan's frame.
/// \param radius of its circumscribed circle, normalised; 0.88 spacings give it the point's share of the surface
Mesh surfels(const PointSurface& surface, double radius);

/// The scan's points whose kept point is one of these (ascending); ascending.
std::vector<int> scan_points(const PointSurface& surface, const std::vector<int>& kept);

}  // namespace orbifit

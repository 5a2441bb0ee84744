#pragma once

#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

namespace orbifit {

struct ScanPreparationOptions {
  int most_points = 6000;  ///< points kept, >= 10
  /// Points spread evenly over the surface; else any of them, as dense as the scan is: a sparse floor stays sparse.
  bool evenly = true;
  int neighbours = 20;  ///< for the normals, >= 3
};

/// A scan as the fit uses it: few enough points, each with a normal.
struct PreparedScan {
  Points points;                  ///< #P by 3
  Points normals;                 ///< #P by 3, unit
  Points viewpoints;              ///< of the points: #P by 3, 1 by 3 for all, or 0 rows when unknown
  bool normals_oriented = false;  ///< they point outwards: given with the scan, or turned towards the viewpoints
  double spacing = 0;             ///< median distance to the nearest other point kept, scan units
  double noise = 0;  ///< median of the root mean square distances of neighbours from their plane, scan units
};

/// Median distance of points to their nearest other one. O(P log P). \pre two points or more
double median_spacing(const Points& points);

/// Keeps at most `most_points` (the first point of each cell of a grid whose width is searched, or random ones) less
/// the strays among them, with normals from the file or from a plane through the nearest points of the whole scan,
/// turned towards the viewpoint where one is known. \throw InputError as check_scan()
PreparedScan prepare_scan(const PointCloud& scan, const ScanPreparationOptions& options, const RunContext& context);

}  // namespace orbifit

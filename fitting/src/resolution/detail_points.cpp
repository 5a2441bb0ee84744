#include "resolution/detail_points.h"

#include <vector>

#include "geometry/point_index.h"
#include "registration/alignment.h"
#include "scan/scan_preparation.h"
#include "scan/thinned_scan.h"

namespace orbifit {

DetailPoints detail_points(const FitInput& input, const PlacedScan& start, const FitResult& result,
                           const RunContext& context) {
  constexpr double kBeside = 2;  // spacings of the points that were used
  const PointIndex used(with_others_moved(start, result.others).points);
  DetailPoints all{Points(0, 3), Points(0, 3), start.views->signed_normals};
  ScanPreparationOptions preparation;
  preparation.most_points = kScanPointsRead;
  const auto append = [](Points& to, const Points& more) {
    to.conservativeResize(to.rows() + more.rows(), 3);
    to.bottomRows(more.rows()) = more;
  };
  const auto add = [&](const PointCloud& cloud, const Motion& into) {
    PreparedScan scan = prepare_scan(cloud, preparation, context);
    scan.points = (scan.points * into.linear.transpose()).rowwise() + into.translation.transpose();
    scan.normals *= into.linear.transpose();
    std::vector<Eigen::Index> kept;
    for (Eigen::Index i = 0; i < scan.points.rows(); ++i) {
      const Eigen::Vector3d point = scan.points.row(i).transpose();
      if (used.any_within(point, kBeside * start.scan.spacing)) kept.push_back(i);
    }
    append(all.points, to_template(result.pose, scan.points(kept, Eigen::all)));
    append(all.normals, normals_to_template(result.pose, scan.normals(kept, Eigen::all)));
  };
  add(input.scan, Motion{});
  for (std::size_t k = 0; k < start.others.size(); ++k) {
    if (start.other_used[k] != 0) add(*input.others[k], result.others[k] * start.others[k]);
  }
  return all;
}

}  // namespace orbifit

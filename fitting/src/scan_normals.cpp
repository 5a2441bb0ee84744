#include "scan_normals.h"

#include <pcl/features/normal_3d.h>
#include <pcl/search/kdtree.h>

namespace orbifit {

Points plane_normals(const Points& points, const std::vector<int>& kept, int neighbours) {
  // PCL computes in float: about the centre, in units of the diagonal, nothing is lost far from the origin.
  const Eigen::RowVector3d centre = bounding_box_centre(points).transpose();
  const double scale = 1 / diagonal(points);
  pcl::PointCloud<pcl::PointXYZ>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZ>);
  cloud->reserve(static_cast<std::size_t>(points.rows()));
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const Eigen::RowVector3f p = ((points.row(i) - centre) * scale).cast<float>();
    cloud->emplace_back(p.x(), p.y(), p.z());
  }
  const pcl::IndicesPtr indices(new pcl::Indices(kept.begin(), kept.end()));
  pcl::NormalEstimation<pcl::PointXYZ, pcl::Normal> estimation;
  estimation.setInputCloud(cloud);
  estimation.setIndices(indices);
  estimation.setSearchMethod(pcl::search::KdTree<pcl::PointXYZ>::Ptr(new pcl::search::KdTree<pcl::PointXYZ>));
  estimation.setKSearch(neighbours);
  pcl::PointCloud<pcl::Normal> estimated;
  estimation.compute(estimated);
  Points normals(static_cast<Eigen::Index>(kept.size()), 3);
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const Eigen::Vector3d normal = estimated[i].getNormalVector3fMap().cast<double>();
    // A neighbourhood without a plane, such as coincident points, has no normal.
    normals.row(static_cast<Eigen::Index>(i)) =
        normal.allFinite() && normal.norm() > 0 ? Eigen::Vector3d(normal.normalized()) : Eigen::Vector3d::UnitZ();
  }
  return normals;
}

}  // namespace orbifit

#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include "orbifit/model/errors.h"
#include "orbifit/model/mesh.h"

namespace orbifit {

/// A point type of PCL with a normal, such as pcl::PointNormal.
template <typename Point>
concept PclPointWithNormal = requires(Point point) {
  point.normal_x;
  point.normal_y;
  point.normal_z;
};

/// A point type of PCL that says where it was seen from, such as pcl::PointWithViewpoint.
template <typename Point>
concept PclPointWithViewpoint = requires(Point point) {
  point.vp_x;
  point.vp_y;
  point.vp_z;
};

/// The scan that a cloud of PCL holds, under the rules of read_scan(): points that are not finite are left out and
/// counted in PointCloud::dropped; normals, made unit, are known if every point that stays has one; viewpoints are the
/// points' own where their type has them, otherwise `sensor_origin_`, unless that is the origin, which PCL has where
/// nobody set it. Row i is the i-th finite point. Colours and the rows of an organised cloud have no place in a scan.
/// \param cloud  of pcl::PointXYZ, pcl::PointNormal or any type with x, y, z
/// \throw InputError when no point remains
template <typename Point>
PointCloud from_pcl(const pcl::PointCloud<Point>& cloud) {
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (std::isfinite(cloud[i].x) && std::isfinite(cloud[i].y) && std::isfinite(cloud[i].z)) kept.push_back(i);
  }
  PointCloud scan;
  scan.dropped = static_cast<int>(cloud.size() - kept.size());
  if (kept.empty()) {
    throw InputError(
        "", "point cloud",
        cloud.empty() ? "has no points" : "has no finite point (" + std::to_string(scan.dropped) + " are not)");
  }
  const auto rows = [&](const auto& vector_of) {
    Points result(static_cast<Eigen::Index>(kept.size()), 3);
    for (std::size_t p = 0; p < kept.size(); ++p) {
      result.row(static_cast<Eigen::Index>(p)) = vector_of(cloud[kept[p]]).transpose();
    }
    return result.allFinite() ? result : Points(0, 3);
  };
  scan.points = rows([](const Point& point) { return Eigen::Vector3d(point.x, point.y, point.z); });
  if constexpr (PclPointWithNormal<Point>) {
    scan.normals = rows([](const Point& point) {
      const Eigen::Vector3d normal(point.normal_x, point.normal_y, point.normal_z);
      return Eigen::Vector3d(normal / normal.stableNorm());  // not finite where it has no length
    });
  }
  if constexpr (PclPointWithViewpoint<Point>) {
    scan.viewpoints = rows([](const Point& point) { return Eigen::Vector3d(point.vp_x, point.vp_y, point.vp_z); });
  }
  const Eigen::Vector3f origin = cloud.sensor_origin_.template head<3>();
  if (scan.viewpoints.rows() == 0 && origin != Eigen::Vector3f::Zero()) {
    scan.viewpoints = origin.cast<double>().transpose();
  }
  return scan;
}

/// A scan as an unorganised cloud of PCL: in single precision, which is coarse far from the origin. A viewpoint that
/// all points share becomes `sensor_origin_`; point types with viewpoints get their own. Point types with normals get
/// them, and, as usual in PCL, NaN where they are unknown (as viewpoints are); pcl::PointXYZ has no place for normals.
/// \tparam Point  pcl::PointXYZ, pcl::PointNormal or any type with x, y, z
/// \throw InputError for a number beyond single precision, and for viewpoints that differ where the point type has none
template <typename Point>
pcl::PointCloud<Point> to_pcl(const PointCloud& scan) {
  // Row `row` of one of the scan's matrices; of one that has no such row, NaN.
  const auto set = [](const Points& rows, Eigen::Index row, const char* what, float& x, float& y, float& z) {
    float* const to[3] = {&x, &y, &z};
    for (Eigen::Index k = 0; k < 3; ++k) {
      const double value = row < rows.rows() ? rows(row, k) : std::numeric_limits<double>::quiet_NaN();
      if (std::abs(value) > static_cast<double>(std::numeric_limits<float>::max())) {
        throw InputError("", "point " + std::to_string(row),
                         std::string("its ") + what + " is beyond single precision");
      }
      *to[k] = static_cast<float>(value);
    }
  };
  pcl::PointCloud<Point> cloud(static_cast<std::uint32_t>(scan.points.rows()), 1);
  const Points& views = scan.viewpoints;
  const bool shared = views.rows() > 0 && (views.rowwise() - views.row(0)).isZero(0);
  if (shared) {
    set(views, 0, "viewpoint", cloud.sensor_origin_[0], cloud.sensor_origin_[1], cloud.sensor_origin_[2]);
  } else if (views.rows() > 0 && !PclPointWithViewpoint<Point>) {
    throw InputError("", "viewpoints", "differ between points, and a cloud of this type of PCL has one for all");
  }
  for (Eigen::Index p = 0; p < scan.points.rows(); ++p) {
    Point& point = cloud[static_cast<std::size_t>(p)];
    set(scan.points, p, "position", point.x, point.y, point.z);
    if constexpr (PclPointWithNormal<Point>) {
      set(scan.normals, p, "normal", point.normal_x, point.normal_y, point.normal_z);
    }
    if constexpr (PclPointWithViewpoint<Point>) {
      set(views, shared ? 0 : p, "viewpoint", point.vp_x, point.vp_y, point.vp_z);
    }
  }
  return cloud;
}

}  // namespace orbifit

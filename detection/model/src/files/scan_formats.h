#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "orbifit/model/mesh.h"

namespace orbifit {

/// Collects a scan while its file is read: leaves out points that are not finite, drops normals that are not known for
/// every point.
class ScanBuilder {
 public:
  explicit ScanBuilder(std::string file) : file_(std::move(file)) {}

  void has_normals() { normals_known_ = true; }
  void has_viewpoints() { viewpoints_known_ = true; }
  void set_viewpoint(const Eigen::Vector3d& viewpoint) { common_viewpoint_ = viewpoint; }
  /// `normal` and `viewpoint` are read only after has_normals() and has_viewpoints().
  void add(const double (&point)[3], const double (&normal)[3], const double (&viewpoint)[3], long long line);

  const std::string& file() const { return file_; }

  /// \throw InputError when no point remains
  PointCloud finish();

 private:
  std::string file_;
  bool normals_known_ = false;
  bool viewpoints_known_ = false;
  Eigen::Vector3d common_viewpoint_ = Eigen::Vector3d::Zero();
  std::vector<double> points_, normals_, viewpoints_;
  int dropped_ = 0;
};

// \throw InputError
void read_ply_scan(std::string_view content, ScanBuilder& builder);
void read_pcd(std::string_view content, ScanBuilder& builder);
void read_xyz(std::string_view content, ScanBuilder& builder);
void read_pts(std::string_view content, ScanBuilder& builder);

std::string ply_bytes(const PointCloud& scan);
std::string pcd_bytes(const std::string& file, const PointCloud& scan);
std::string xyz_text(const PointCloud& scan);
std::string pts_text(const PointCloud& scan);

}  // namespace orbifit

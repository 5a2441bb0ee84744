#include "orbifit/model/scan_io.h"

#include <cmath>

#include "orbifit/model/errors.h"

#include "files/binary.h"
#include "files/file.h"
#include "files/mesh_formats.h"
#include "files/ply.h"
#include "files/scan_formats.h"
#include "files/text.h"

namespace orbifit {

namespace {

bool finite(const double (&values)[3]) {
  return std::isfinite(values[0]) && std::isfinite(values[1]) && std::isfinite(values[2]);
}

Points to_points(const std::vector<double>& values) {
  return Eigen::Map<const Points>(values.data(), static_cast<Eigen::Index>(values.size() / 3), 3);
}

}  // namespace

void ScanBuilder::add(const double (&point)[3], const double (&normal)[3], const double (&viewpoint)[3],
                      long long line) {
  if (!finite(point)) {
    ++dropped_;
    return;
  }
  const auto number = static_cast<long long>(points_.size() / 3) + dropped_;
  check_coordinates(file_, line, number, point);
  points_.insert(points_.end(), point, point + 3);
  if (normals_known_) {
    const Eigen::Vector3d vector(normal[0], normal[1], normal[2]);
    const double length = vector.stableNorm();
    normals_known_ = length > 0 && std::isfinite(length);
    const Eigen::Vector3d unit = vector / length;
    normals_.insert(normals_.end(), unit.data(), unit.data() + 3);
  }
  if (viewpoints_known_) {
    viewpoints_known_ = finite(viewpoint);
    viewpoints_.insert(viewpoints_.end(), viewpoint, viewpoint + 3);
  }
}

PointCloud ScanBuilder::finish() {
  if (points_.empty()) {
    throw InputError(
        file_, "", dropped_ == 0 ? "has no points" : "has no finite point (" + std::to_string(dropped_) + " are not)");
  }
  PointCloud scan;
  scan.points = to_points(points_);
  if (normals_known_) scan.normals = to_points(normals_);
  if (viewpoints_known_) {
    scan.viewpoints = to_points(viewpoints_);
  } else if (common_viewpoint_ != Eigen::Vector3d::Zero()) {
    scan.viewpoints = common_viewpoint_.transpose();
  }
  scan.dropped = dropped_;
  return scan;
}

void read_ply_scan(std::string_view content, ScanBuilder& builder) {
  int columns[9] = {};
  const auto begin = [&](const PlyElement& element) {
    if (element.name != "vertex") return;
    const char* names[9] = {"x", "y", "z", "nx", "ny", "nz", "vx", "vy", "vz"};
    const auto find = [&](int c) {
      columns[c] = element.find(names[c]);
      return columns[c] >= 0 && !element.properties[static_cast<std::size_t>(columns[c])].count_type;
    };
    for (int c = 0; c < 3; ++c) {
      if (!find(c))
        throw InputError(builder.file(), "header", std::string("element 'vertex' has no property '") + names[c] + "'");
    }
    if (find(3) && find(4) && find(5)) builder.has_normals();
    if (find(6) && find(7) && find(8)) builder.has_viewpoints();
  };
  const auto visit = [&](const PlyElement& element, const PlyRow& row) {
    if (element.name != "vertex") return;
    const auto value = [&](int c) { return columns[c] < 0 ? 0.0 : row.values[static_cast<std::size_t>(columns[c])]; };
    builder.add({value(0), value(1), value(2)}, {value(3), value(4), value(5)}, {value(6), value(7), value(8)},
                row.line);
  };
  visit_ply(builder.file(), content, begin, visit);
}

std::string ply_bytes(const PointCloud& scan) {
  const Eigen::Index count = scan.points.rows();
  const bool normals = scan.normals.rows() == count && count > 0;
  const bool viewpoints = scan.viewpoints.rows() > 0;
  const auto properties = [](const char* prefix) {
    std::string text;
    for (const char axis : {'x', 'y', 'z'}) text += std::string("property double ") + prefix + axis + "\n";
    return text;
  };
  std::string bytes = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(count) + "\n" +
                      properties("") + (normals ? properties("n") : "") + (viewpoints ? properties("v") : "") +
                      "end_header\n";
  for (Eigen::Index p = 0; p < count; ++p) {
    for (int k = 0; k < 3; ++k) store(bytes, scan.points(p, k));
    for (int k = 0; normals && k < 3; ++k) store(bytes, scan.normals(p, k));
    // One viewpoint for all is written for each: a PLY has no other place for it.
    for (int k = 0; viewpoints && k < 3; ++k) store(bytes, scan.viewpoints(scan.viewpoints.rows() == count ? p : 0, k));
  }
  return bytes;
}

PointCloud read_scan(const std::filesystem::path& file) {
  const std::string content = read_file(file);
  const std::string ending = format_ending(file, content);
  ScanBuilder builder(file.string());
  if (ending == ".ply") {
    read_ply_scan(content, builder);
  } else if (ending == ".pcd") {
    read_pcd(content, builder);
  } else if (ending == ".xyz") {
    read_xyz(content, builder);
  } else if (ending == ".pts") {
    read_pts(content, builder);
  } else if (const MeshReader read = mesh_reader(ending); read != nullptr) {
    MeshBuilder mesh(file.string());
    read(file, content, mesh);
    PointCloud scan;
    scan.points = mesh.finish(false).vertices;
    return scan;
  } else {
    throw InputError(file.string(), "",
                     "unknown ending " + in_quotes(file.extension().string()) +
                         ": scans are read from .ply, .pcd, .xyz and .pts, or from a mesh's vertices");
  }
  return builder.finish();
}

void write_scan(const std::filesystem::path& file, const PointCloud& scan) {
  const std::string ending = lower_extension(file);
  if (ending == ".ply") return write_file(file, ply_bytes(scan));
  if (ending == ".pcd") return write_file(file, pcd_bytes(file.string(), scan));
  if (ending == ".xyz") return write_file(file, xyz_text(scan));
  if (ending == ".pts") return write_file(file, pts_text(scan));
  if (file == "-") throw UsageError("standard output needs a format: --output-format ply, pcd, xyz or pts");
  throw UsageError(file.string() + ": unknown ending " + in_quotes(file.extension().string()) +
                   ": scans are written as .ply, .pcd, .xyz or .pts");
}

}  // namespace orbifit

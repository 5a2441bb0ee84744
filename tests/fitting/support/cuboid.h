#pragma once

#include <vector>

#include <Eigen/Core>

#include "orbifit/model/mesh.h"

#include "scan/scan_preparation.h"

namespace orbifit {

constexpr int kCuboidCells = 24;

/// A cuboid about the origin of sides 3, 2 and 1, six faces of 24 x 24 cells each with vertices of its own, those of
/// one direction together: low x, high x, low y, ...
inline Mesh cuboid() {
  const Eigen::Vector3d sides(3, 2, 1);
  Mesh mesh;
  mesh.vertices.resize(6 * (kCuboidCells + 1) * (kCuboidCells + 1), 3);
  mesh.faces.resize(6 * 2 * kCuboidCells * kCuboidCells, 3);
  int vertex = 0, face = 0;
  for (int side = 0; side < 6; ++side) {
    const int axis = side / 2, a = (axis + 1) % 3, b = (axis + 2) % 3;
    const int first = vertex;
    for (int i = 0; i <= kCuboidCells; ++i) {
      for (int k = 0; k <= kCuboidCells; ++k) {
        Eigen::Vector3d point;
        point[axis] = (side % 2 - 0.5) * sides[axis];
        point[a] = (static_cast<double>(i) / kCuboidCells - 0.5) * sides[a];
        point[b] = (static_cast<double>(k) / kCuboidCells - 0.5) * sides[b];
        mesh.vertices.row(vertex++) = point.transpose();
      }
    }
    for (int i = 0; i < kCuboidCells; ++i) {
      for (int k = 0; k < kCuboidCells; ++k) {
        const int corner = first + i * (kCuboidCells + 1) + k, next = corner + kCuboidCells + 1;
        const bool out = side % 2 == 1;
        mesh.faces.row(face++) << corner, out ? next : next + 1, out ? next + 1 : next;
        mesh.faces.row(face++) << corner, out ? next + 1 : corner + 1, out ? corner + 1 : next + 1;
      }
    }
  }
  return mesh;
}

/// The vertices of some of its faces.
inline PreparedScan scan_of_faces(const Mesh& cuboid, const std::vector<int>& faces) {
  const Eigen::Index each = cuboid.vertices.rows() / 6;
  PreparedScan scan;
  scan.points.resize(each * std::ssize(faces), 3);
  scan.normals = Points::Zero(scan.points.rows(), 3);
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const Eigen::Index first = each * static_cast<Eigen::Index>(i);
    scan.points.middleRows(first, each) = cuboid.vertices.middleRows(each * faces[i], each);
    scan.normals.middleRows(first, each).col(faces[i] / 2).setConstant(faces[i] % 2 * 2 - 1);
  }
  scan.spacing = 1.0 / kCuboidCells;
  return scan;
}

}  // namespace orbifit

#pragma once

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"

namespace orbifit {

/// The unit cube about the origin, every side a square of `cells` by `cells`, each of four triangles about its middle,
/// so that all 48 symmetries map faces onto faces.
inline Mesh cube_mesh(int cells = 4) {
  std::vector<Eigen::RowVector3d> vertices;
  std::vector<Eigen::RowVector3i> faces;
  for (int axis = 0; axis < 3; ++axis) {
    for (const int side : {-1, 1}) {
      const int first = static_cast<int>(vertices.size());
      const auto place = [&](double u, double v) {
        Eigen::RowVector3d point;
        point[axis] = 0.5 * side;
        point[(axis + 1) % 3] = side * (u / cells - 0.5);
        point[(axis + 2) % 3] = v / cells - 0.5;
        vertices.push_back(point);
      };
      for (int j = 0; j <= cells; ++j) {
        for (int i = 0; i <= cells; ++i) place(i, j);
      }
      for (int j = 0; j < cells; ++j) {
        for (int i = 0; i < cells; ++i) {
          const int a = first + j * (cells + 1) + i;
          const int middle = static_cast<int>(vertices.size());
          place(i + 0.5, j + 0.5);
          const int ring[4] = {a, a + 1, a + cells + 2, a + cells + 1};
          for (int k = 0; k < 4; ++k) faces.emplace_back(ring[k], ring[(k + 1) % 4], middle);
        }
      }
    }
  }
  Mesh mesh;
  mesh.vertices.resize(static_cast<Eigen::Index>(vertices.size()), 3);
  mesh.faces.resize(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t v = 0; v < vertices.size(); ++v) mesh.vertices.row(static_cast<Eigen::Index>(v)) = vertices[v];
  for (std::size_t f = 0; f < faces.size(); ++f) mesh.faces.row(static_cast<Eigen::Index>(f)) = faces[f];
  return mesh;
}

/// The cube's full group, as a ground truth.
inline SymmetryAnnotation cube_annotation(const Mesh& mesh) {
  SymmetryAnnotation annotation = empty_annotation(mesh, 0.005);
  std::vector<int> faces(static_cast<std::size_t>(mesh.faces.rows()));
  for (std::size_t f = 0; f < faces.size(); ++f) faces[f] = static_cast<int>(f);
  annotation.regions.push_back(make_region(*PointGroup::parse("Oh"), Eigen::Vector3d::Zero(),
                                           Eigen::Matrix3d::Identity(), std::move(faces), "cube"));
  return annotation;
}

}  // namespace orbifit

#pragma once

#include <vector>

#include <Eigen/Core>

namespace orbifit {

using Points = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;  ///< #P by 3, one point a row
using Triangles = Eigen::Matrix<int, Eigen::Dynamic, 3, Eigen::RowMajor>;  ///< #F by 3, vertex numbers from 0

/// A triangle mesh as it stands in its file: order and duplicates kept, no assumption on manifoldness.
struct Mesh {
  Points vertices;  ///< #V by 3, finite, in the mesh's own units
  Triangles faces;  ///< #F by 3
  /// The file's polygon from which each triangle was cut, as a fan from the polygon's first corner, #F, ascending;
  /// empty when the file's faces are the triangles.
  std::vector<int> polygon_of_face;
};

/// A scan: points, and normals and viewpoints where known.
struct PointCloud {
  Points points;      ///< #P by 3, finite
  Points normals;     ///< #P by 3, unit; 0 rows when unknown
  Points viewpoints;  ///< where each point was seen from: #P by 3, 1 by 3 for all, or 0 rows when unknown
  int dropped = 0;    ///< points of the file left out because they are not finite
};

/// Length of the diagonal of the bounding box over all rows; 0 for no points.
double diagonal(const Points& points);

Eigen::Vector3d bounding_box_centre(const Points& points);

/// Unit normal of a triangle; zero for a degenerate one.
Eigen::Vector3d face_normal(const Mesh& mesh, Eigen::Index face);

/// The same of each triangle, #F by 3.
Points face_normals(const Mesh& mesh);

/// Area of each triangle, #F.
Eigen::VectorXd face_areas(const Mesh& mesh);

/// Mean of each triangle's corners, #F by 3.
Points face_centroids(const Mesh& mesh);

/// Area-weighted unit normal at each vertex, #V by 3; zero where no face of positive area meets.
Points vertex_normals(const Mesh& mesh);

/// The mesh of some of the faces with the vertices they use; vertices keep their order. Of few faces the cost does not
/// grow with the mesh.
/// \param[out] vertex_of for each vertex of the result its number in `mesh`; may be null
Mesh submesh(const Mesh& mesh, const std::vector<int>& faces, std::vector<int>* vertex_of = nullptr);

/// All vertices that some faces use, ascending.
std::vector<int> vertices_of_faces(const Mesh& mesh, const std::vector<int>& faces);

}  // namespace orbifit

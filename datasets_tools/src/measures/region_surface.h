#pragma once

#include <vector>

#include <Eigen/Core>

#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

#include "geometry/vertex_finder.h"

namespace orbifit {

/// A point of a surface by its place in the connectivity, so that it can be found again after a deformation.
struct SurfacePlace {
  int vertex = -1;                                    ///< the vertex, where the point is one
  int face = -1;                                      ///< else the face ...
  Eigen::Vector2d weights = Eigen::Vector2d::Zero();  ///< ... and the weights of its corners 1 and 2

  Eigen::Vector3d operator()(const Mesh& mesh) const;
};

/// Some faces of a mesh, to find the place that a point of space has on them.
class RegionSurface {
 public:
  /// \param reach distance within which a point is said to be at a vertex, mesh units, > 0
  RegionSurface(const Mesh& mesh, const std::vector<int>& faces, double reach);
  RegionSurface(const RegionSurface&) = delete;
  RegionSurface& operator=(const RegionSurface&) = delete;

  const std::vector<int>& vertices() const { return vertices_; }  ///< of the mesh, ascending
  const Points& positions() const { return patch_.vertices; }     ///< of vertices(), #R by 3
  const Points& normals() const { return normals_; }              ///< of vertices() within the region, #R by 3
  const Mesh& patch() const { return patch_; }                    ///< the faces alone, in their order, on vertices()

  /// The nearest vertex within reach, of several at one place the one whose normal agrees best; else the nearest point
  /// of the faces, on the side that faces as `normals` do where a thin part has both sides near.
  std::vector<SurfacePlace> places(const Points& points, const Points& normals, const RunContext& context) const;

  /// Of vertices(), by number there, to which a point is within reach. Where it is but one, no normal is needed to tell
  /// which is meant.
  const VertexFinder& vertex_finder() const { return finder_; }

  Eigen::Vector3d point_at(const SurfacePlace& place) const { return place(mesh_); }
  Eigen::Vector3d normal_at(const SurfacePlace& place) const;  ///< of one of places(): unit, or zero

 private:
  int vertex_at(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const;

  const Mesh& mesh_;
  std::vector<int> faces_;
  double reach_;
  std::vector<int> vertices_;
  Mesh patch_;
  Points normals_;
  VertexFinder finder_;  // of patch_
};

}  // namespace orbifit

#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

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

  const std::vector<int>& vertices() const { return vertices_; }  ///< of the mesh, ascending
  const Points& positions() const { return patch_.vertices; }     ///< of vertices(), #R by 3
  const Points& normals() const { return normals_; }              ///< of vertices() within the region, #R by 3
  const Mesh& patch() const { return patch_; }                    ///< the faces alone, in their order, on vertices()

  /// The nearest vertex within reach, of several at one place the one whose normal agrees best; else the nearest point
  /// of the faces, on the side that faces as `normals` do where a thin part has both sides near.
  std::vector<SurfacePlace> places(const Points& points, const Points& normals, const RunContext& context) const;

  /// The vertex within reach of a point, by number within vertices(), where there is but one: no normal is needed to
  /// tell which is meant then. kNone or kSeveral else.
  int lone_vertex_at(const Eigen::Vector3d& point) const;
  static constexpr int kNone = -1;
  static constexpr int kSeveral = -2;

  Eigen::Vector3d point_at(const SurfacePlace& place) const { return place(mesh_); }
  Eigen::Vector3d normal_at(const SurfacePlace& place) const;  ///< of one of places(): unit, or zero

 private:
  struct Cell {
    std::int64_t key;
    int vertex;  // number within the region
  };
  std::int64_t key_of(const Eigen::Vector3d& cell) const;
  template <class Visit>
  void visit_near(const Eigen::Vector3d& point, const Visit& visit) const;
  int vertex_at(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const;

  const Mesh& mesh_;
  std::vector<int> faces_;
  double reach_;
  double cell_size_;
  Eigen::Vector3d origin_;
  std::vector<int> vertices_;
  Mesh patch_;
  Points normals_;
  std::vector<Cell> cells_;         // ordered by slot
  std::vector<int> first_of_slot_;  // #slots + 1
};

}  // namespace orbifit

#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"
#include "orbifit/subspace/subspace.h"

#include "geometry/surface_index.h"

namespace orbifit {

/// Vectors at a mesh's vertices as a field over its surface: at any point the mean over the faces nearest to it, on
/// each of which they are linear. Faces as near as the nearest but for rounding count alike, so that rounding does not
/// choose among parts that touch.
class SurfaceVectors {
 public:
  /// \param mesh  at rest; copied as far as needed
  explicit SurfaceVectors(const Mesh& mesh);

  struct Part {
    int vertex;
    double weight;
  };
  /// The vertices on which a point's vector depends, with weights that sum to 1. O(log F)
  void parts_at(const Eigen::Vector3d& point, std::vector<Part>& parts) const;

 private:
  SurfaceIndex surface_;
  Triangles faces_;
  double alike_;  // mesh units
};

/// What a state adds to the displacement of its coordinates, finer than the samples tell: at each point of an orbit the
/// vectors of the surface there, taken back to where the orbit starts, and the mean of all, carried to its points. So
/// it is as symmetric as that displacement: in every region, at vertices and between them (docs/method.md 7.1).
struct SurfaceDetail {
  std::shared_ptr<const SurfaceVectors> surface;
  Points vectors;  ///< #V by 3, where the groups are now
  Points
      of_representatives;  ///< #R by 3: what that makes of the orbits of vertices (VertexOrbits), before they bind it
};

/// How vectors at the vertices, each a fixed direction times a height that its orbit's vertices share, move the
/// representatives: u_r = sum of direction * height over its parts. Linear, and local.
struct DetailMap {
  struct Part {
    int representative;  ///< whose height it is
    Eigen::Vector3d direction;
  };
  std::vector<std::int64_t> first;  ///< of each representative's parts, and their number at the end
  std::vector<Part> parts;
};

/// \param directions #V by 3, where the groups are now
/// O(points of all orbits * log F)
DetailMap detail_map(const Subspace& subspace, const SubspaceState& state, const SurfaceVectors& surface,
                     const Points& directions, const RunContext& context);

/// \param heights #R
std::shared_ptr<const SurfaceDetail> surface_detail(const Subspace& subspace,
                                                    std::shared_ptr<const SurfaceVectors> surface, const DetailMap& map,
                                                    const Points& directions, const Eigen::VectorXd& heights);

}  // namespace orbifit

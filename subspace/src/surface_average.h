#pragma once

#include <memory>
#include <vector>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"
#include "orbifit/model/surface_index.h"
#include "orbifit/subspace/region_map.h"

namespace orbifit {

/// The mean over a point's orbit of the surface's nearest points, taken back: p -> mean of M_k^-1(nearest(M_k p)).
/// Here alone the symmetrisation follows orbits of points between vertices.
class SurfaceAverage {
 public:
  /// \param annotation finite groups only
  /// \param reach images farther than this from their region's surface are not counted, mesh units
  SurfaceAverage(const Mesh& mesh, const SymmetryAnnotation& annotation, double reach, const RunContext& context);

  /// \param normal unit, outward at `point`; zero: unknown
  /// \param face   on which the point lies
  /// \throw InputError when the orbit does not close
  Eigen::Vector3d operator()(const Eigen::Vector3d& point, const Eigen::Vector3d& normal, int face) const;

 private:
  RegionMap regions_;
  std::vector<SurfaceIndex> surfaces_;  ///< of each region
  std::vector<std::size_t> sizes_;      ///< faces of each region
  double reach_;
  double doublet_;
};

}  // namespace orbifit

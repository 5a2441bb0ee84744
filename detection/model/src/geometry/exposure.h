#pragma once

#include <vector>

#include <Eigen/Core>

#include "orbifit/model/mesh.h"

#include "geometry/surface_index.h"

namespace orbifit {

/// Whether a straight way leads from a point of a mesh's surface out of it: what lies within the mesh, or in a gap, no
/// scanner can see. By 64 directions. Const calls may run on several threads.
class Exposure {
 public:
  explicit Exposure(const Mesh& mesh);

  bool operator()(const Eigen::Vector3d& point) const;

 private:
  SurfaceIndex surface_;
  double size_;
  std::vector<Eigen::Vector3d> directions_;
};

}  // namespace orbifit

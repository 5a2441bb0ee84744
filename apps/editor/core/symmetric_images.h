#pragma once

#include <vector>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"

#include "geometry/surface_index.h"

namespace orbifit::editor {

/// A point of the surface.
struct SurfacePoint {
  int face = -1;
  Eigen::Vector3d barycentric = Eigen::Vector3d::Zero();
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  ///< at rest, mesh units
};

/// Where the groups and patterns of an annotation take points of the surface.
class SymmetricImages {
 public:
  SymmetricImages(const Mesh& mesh, const SymmetryAnnotation& annotation);

  /// The point's orbit under all regions and patterns that hold it or one of its images, itself first; at most some
  /// hundreds. Of a continuous group images stand around the circle; those over a sphere are left out.
  std::vector<SurfacePoint> orbit(const SurfacePoint& point) const;

  /// Numbers, in the annotation's order, of the regions that hold a face.
  std::vector<int> regions_of(int face) const;

  /// Motions that take points of region `region` to others of it; of continuous groups some.
  const std::vector<Motion>& motions(int region) const { return domains_[static_cast<std::size_t>(region)].motions; }

  const SurfaceIndex& surface() const { return surface_; }

 private:
  struct Domain {
    std::vector<char> holds;  // #F
    std::vector<Motion> motions;
  };
  void add(const std::vector<int>& faces, std::vector<Motion> motions);

  const Mesh& mesh_;
  SurfaceIndex surface_;
  double near_ = 0;              // points nearer than this are one
  double reach_ = 0;             // how far an image may lie from the surface
  int regions_ = 0;              // the first domains are the regions, in the annotation's order
  std::vector<Domain> domains_;  // then each instance of each pattern
};

}  // namespace orbifit::editor

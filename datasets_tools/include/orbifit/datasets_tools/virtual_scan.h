#pragma once

#include <optional>
#include <vector>

#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

namespace orbifit {

/// A depth camera that looks at a mesh (design.md, `scan`).
struct ScanOptions {
  int views = 1;              ///< >= 1; spread evenly in azimuth, starting at `azimuth`
  double azimuth = 30;        ///< of the first view, degrees about z from +x
  double elevation = 20;      ///< degrees above the horizon, in (-90, 90)
  double distance = 2;        ///< camera to centre, in diagonals, > 0.6
  int width = 320;            ///< pixels, >= 8
  int height = 240;           ///< pixels, >= 8
  double field_of_view = 40;  ///< vertical, degrees, in (1, 120)
  double noise = 0;           ///< standard deviation along the ray, fraction of the diagonal, >= 0
  double outliers = 0;        ///< fraction of points replaced by uniform ones in the box, in [0, 1)
  double clutter = 0;         ///< fraction of points that lie on a floor and blocks around the mesh, in [0, 0.9]
  double grazing_limit = 80;  ///< degrees between ray and normal above which a pixel is lost, in (0, 90]
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();

  void validate() const;  ///< \throw UsageError
};

/// Points in the mesh's frame with viewpoints; no normals (a scanner gives none). Occluded surface is not seen.
/// \throw NoResultError when no pixel sees the mesh
PointCloud virtual_scan(const Mesh& mesh, const ScanOptions& options, RunContext& context);

}  // namespace orbifit

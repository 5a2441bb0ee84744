#pragma once

#include <filesystem>
#include <vector>

#include <Eigen/Core>

#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"
#include "orbifit/subspace/subspace.h"

namespace orbifit {

/// Part of space in which sampling is finer or coarser.
struct PaintedArea {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double radius = 0;  ///< mesh units, > 0
  double factor = 1;  ///< of the base radius, > 0
};

/// How the sampling radius varies over the surface (docs/method.md 2.5).
struct RadiusFieldOptions {
  double base = 0;                 ///< r where nothing else is said, mesh units, > 0
  std::vector<PaintedArea> areas;  ///< where several hold a point the smallest factor counts
  bool feature_size = false;       ///< finer on thin parts: half the local thickness, within the two limits below
  double smallest = 0.5;           ///< least factor from the thickness, > 0
  double largest = 1;              ///< greatest factor from the thickness, >= smallest
  double gradation = 0.5;          ///< r(p) <= r(q) + gradation |p - q|, > 0

  void validate() const;  ///< \throw UsageError
};

/// The sampling radius at each vertex, #V, mesh units, > 0: base, thickness or the factor of a painted area, then
/// lowered so that it changes by no more than the gradation: an area finer than its surroundings grows into them, a
/// coarser one shrinks. The thickness at a point is the diameter of the largest ball inside the surface that touches it
/// there and no face on the other side. A function of positions and distances, so it has the mesh's symmetries.
/// Distances are straight ones about areas, and along edges and to the eight nearest vertices elsewhere. O(V log V).
Eigen::VectorXd radius_field(const Mesh& mesh, const RadiusFieldOptions& options, const RunContext& context);

/// Reads {"areas": [{"centre": [x, y, z], "radius": R, "factor": F}], "feature_size": true, "smallest": S,
/// "largest": L, "gradation": G}; every key may be left out.
/// \param base the base radius, mesh units
/// \throw InputError naming the file, the key and the reason
RadiusFieldOptions read_radius_field(const std::filesystem::path& file, double base);

/// What such a file makes of the radius at each vertex, #V, relative to the base radius: the one that the options give,
/// or else the one that their number of samples suggests. For SubspaceOptions::relative_radii.
/// \throw UsageError, InputError
Eigen::VectorXd relative_radii(const Mesh& mesh, const std::filesystem::path& file, const SubspaceOptions& options,
                               const RunContext& context);

}  // namespace orbifit
